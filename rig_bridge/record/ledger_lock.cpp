#include "rig_bridge/record/ledger_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include "rig_bridge/record/ledger.hpp"

namespace rig {

namespace {

std::string lock_file(const std::filesystem::path& ledger) {
    return ledger.string() + "-held";
}

/// is_held() has it for an instant, too.
bool locks(int file) {
    constexpr int kTries = 5;
    constexpr std::chrono::milliseconds kBetween{20};
    for (int i = 0; i < kTries; ++i) {
        if (flock(file, LOCK_EX | LOCK_NB) == 0) return true;
        std::this_thread::sleep_for(kBetween);
    }
    return false;
}

}  // namespace

int LedgerLock::take(const std::filesystem::path& ledger) {
    const std::string path = lock_file(ledger);
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) throw LedgerError(path + ": " + std::strerror(errno));
    if (locks(file)) {
        const std::string pid = std::to_string(getpid()) + "\n";
        // Only for the message below.
        static_cast<void>(ftruncate(file, 0) == 0 && pwrite(file, pid.data(), pid.size(), 0) > 0);
        return file;
    }
    std::array<char, 24> text{};
    const ssize_t size = pread(file, text.data(), text.size() - 1, 0);
    std::string pid(text.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
    while (!pid.empty() && pid.back() == '\n') pid.pop_back();
    ::close(file);
    throw LedgerError(ledger.string() + ": is held by another program" +
                      (pid.empty() ? "" : " (process " + pid + ")") +
                      "; one bridge at a time may run campaigns on it");
}

std::optional<std::string> held_by_another(const std::filesystem::path& path) {
    try {
        const LedgerLock lock(path);
        return std::nullopt;
    } catch (const LedgerError& error) {
        return error.what();
    }
}

bool is_held(const std::filesystem::path& path) {
    const settings::FileDescriptor file(::open(lock_file(path).c_str(), O_RDONLY | O_CLOEXEC));
    return file.is_open() && flock(file.get(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

}  // namespace rig
