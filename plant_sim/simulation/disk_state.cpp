#include "plant_sim/simulation/disk_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace plant_sim::simulation {

namespace {

std::string parent(const std::string& path) {
    return std::filesystem::path(path).parent_path().string();
}

void change_bytes(const FileChange& change, std::string& to) {
    if (change.cuts) {
        to.resize(change.offset);
        return;
    }
    if (to.size() < change.offset) to.resize(change.offset);
    to.replace(change.offset, change.bytes.size(), change.bytes);
}

}  // namespace

DiskState::DiskState(std::uint64_t seed, DiskTrace sink)
    : generator(wear::generator_of(seed, 1)), trace(std::move(sink)), sector(happens(0.5) ? 512 : 4096) {
    names["/"] = stored_names_["/"] = std::make_shared<Node>(Node{.directory = true});
}

std::optional<DiskFault> DiskState::next(Kind kind) {
    if (paused) return std::nullopt;
    ++operations;
    ++since_restart;
    for (auto due = pending.begin(); due != pending.end(); ++due) {
        if (since_restart < due->at) continue;
        const DiskFault fault = due->fault;
        if (fault == DiskFault::no_space && kind != Kind::write && kind != Kind::create) continue;
        if (fault == DiskFault::short_write && kind != Kind::write) continue;
        const bool ends = fault == DiskFault::power_cut || fault == DiskFault::kill;
        if (kind == Kind::must_not_fail && !ends) continue;
        ++fault_counts.at(static_cast<std::size_t>(fault));
        if (--due->lasts == 0) pending.erase(due);
        runs = runs && !ends;
        killed_ = fault == DiskFault::kill;
        return fault;
    }
    return std::nullopt;
}

int DiskState::said(std::string_view what, const std::string& path, int error) const {
    if (!trace) return error;
    std::string name = path;
    if (const auto dot = name.find("/.write-"); dot != std::string::npos) name.resize(dot + 7);  // the rest is a process number
    trace(fmt::format("{:5}  {} {}{}", since_restart, what, name,
                      killed_      ? ": KILLED"
                      : !runs      ? ": POWER CUT"
                      : error != 0 ? fmt::format(": {}", std::strerror(error))
                                   : ""));
    return error;
}

NodePointer DiskState::find(const std::string& path) const {
    const auto found = names.find(path);
    return found == names.end() ? nullptr : found->second;
}

void DiskState::change(Node& node, FileChange by) {
    change_bytes(by, node.now);
    node.cached.push_back(std::move(by));
    node.version = ++versions_;
}

std::int64_t DiskState::write(Node& node, const std::string& path, std::size_t offset, std::string_view bytes) {
    if (!runs) return -EIO;
    const auto fault = next(Kind::write);
    const std::string what = trace ? fmt::format("write {} bytes at {} to", bytes.size(), offset) : "";
    if (fault == DiskFault::no_space) return -said(what, path, ENOSPC);
    if (fault == DiskFault::refused) return -said(what, path, EIO);
    if (fault == DiskFault::short_write && bytes.size() > 1) bytes = bytes.substr(0, 1 + generator() % (bytes.size() - 1));
    change(node, {.offset = offset, .bytes = std::string(bytes)});
    if (trace && fault == DiskFault::short_write) trace(fmt::format("       only {} bytes of the next are taken", bytes.size()));
    return said(what, path, runs ? 0 : EIO) != 0 ? -EIO : static_cast<std::int64_t>(bytes.size());
}

int DiskState::truncate(Node& node, const std::string& path, std::size_t size) {
    if (!runs) return EIO;
    if (next(Kind::other)) return said("truncate", path, EIO);
    change(node, {.offset = size, .cuts = true});
    return said("truncate", path, 0);
}

int DiskState::sync(Node& node, const std::string& path) {
    if (!runs) return EIO;
    const auto fault = next(Kind::sync);
    if (fault == DiskFault::refused) keep_some(node, 0.5);
    if (fault) return said("sync", path, EIO);
    for (const FileChange& change : node.cached) change_bytes(change, node.stored);
    node.cached.clear();
    return said("sync", path, 0);
}

void DiskState::apply(const NameChange& change, std::map<std::string, NodePointer>& to) const {
    if (!change.removed.empty()) to.erase(change.removed);
    if (!change.added.empty()) to[change.added] = change.node;
}

int DiskState::change_name(Kind kind, std::string_view what, const NameChange& change) {
    const std::string& path = change.added.empty() ? change.removed : change.added;
    if (const auto fault = next(kind)) return said(what, path, fault == DiskFault::no_space ? ENOSPC : EIO);
    apply(change, names);
    cached_names_.push_back(change);
    return said(what, path, 0);
}

int DiskState::make(const std::string& path, bool directory) {
    if (!runs) return EIO;
    if (find(path)) return EEXIST;
    if (!find(parent(path))) return ENOENT;
    const auto node = std::make_shared<Node>(Node{.directory = directory});
    const int error =
        change_name(Kind::create, directory ? "make directory" : "create", {.directory = parent(path), .removed = {}, .added = path, .node = node});
    if (error == 0) nodes_.push_back(node);
    return error;
}

int DiskState::remove(const std::string& path) {
    if (!runs) return EIO;
    if (!find(path)) return ENOENT;
    return change_name(Kind::other, "remove", {.directory = parent(path), .removed = path});
}

int DiskState::rename(const std::string& from, const std::string& to) {
    if (!runs) return EIO;
    const NodePointer node = find(from);
    if (!node) return ENOENT;
    return change_name(Kind::other, "rename to", {.directory = parent(to), .removed = from, .added = to, .node = node});
}

int DiskState::sync_directory(const std::string& path, bool refusable) {
    if (!runs) return EIO;
    if (next(refusable ? Kind::sync : Kind::must_not_fail)) return said("sync directory", path, EIO);
    std::vector<NameChange> others;
    for (NameChange& change : cached_names_) {
        if (change.directory == path)
            apply(change, stored_names_);
        else
            others.push_back(std::move(change));
    }
    cached_names_ = std::move(others);
    return said("sync directory", path, 0);
}

void DiskState::keep_some(Node& node, double share) {
    constexpr double kTorn = 0.25;
    for (const FileChange& change : node.cached) {
        if (change.cuts && happens(share)) change_bytes(change, node.stored);
        for (std::size_t done = 0; done < change.bytes.size();) {
            const std::size_t at = change.offset + done;
            const std::size_t size = std::min(change.bytes.size() - done, sector - at % sector);
            std::size_t kept = size;
            if (!happens(share)) kept = happens(kTorn) ? generator() % size : 0;
            if (kept > 0) change_bytes({.offset = at, .bytes = change.bytes.substr(done, kept)}, node.stored);
            done += size;
        }
    }
    node.cached.clear();
}

void DiskState::kill() {
    killed_ = killed_ || runs;
    runs = false;
}

void DiskState::restart() {
    if (runs) ++fault_counts.at(static_cast<std::size_t>(DiskFault::power_cut));
    if (!std::exchange(killed_, false)) lose_cache();
    held.clear();
    pending.clear();
    since_restart = 0;
    runs = true;
}

void DiskState::lose_cache() {
    // A disk that was idle has everything, one that was writing a part.
    constexpr std::array kShares{0.0, 0.5, 0.9, 1.0};
    const double share = kShares.at(generator() % kShares.size());
    for (const NodePointer& node : nodes_) {
        keep_some(*node, share);
        if (node->now == node->stored) continue;
        node->now = node->stored;
        node->version = ++versions_;
    }
    for (const NameChange& change : cached_names_)
        if (happens(share)) apply(change, stored_names_);
    cached_names_.clear();
    // In the order of names, so that a directory precedes its contents.
    for (auto entry = stored_names_.begin(); entry != stored_names_.end();)
        entry = stored_names_.contains(parent(entry->first)) ? std::next(entry) : stored_names_.erase(entry);
    names = stored_names_;
    std::erase_if(nodes_, [](const NodePointer& node) { return node.use_count() == 1; });
}

}  // namespace plant_sim::simulation
