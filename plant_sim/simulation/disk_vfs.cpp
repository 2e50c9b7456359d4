// SQLite's files on a simulated disk. Directories are synced as by SQLite's unix VFS: after the first sync of a journal that was created or found
// there, ignoring a failure, and after a removal if SQLite requests it.
#include <sqlite3.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

#include "plant_sim/simulation/disk_state.hpp"

namespace plant_sim::simulation {

namespace {

struct OpenFile {
    sqlite3_file base;  // SQLite uses the object through this member
    DiskState* disk;
    NodePointer node;
    std::string path;
    bool names_new;  // its directory is to be synced with it
    bool passing;    // removed when closed
};

OpenFile& of(sqlite3_file* file) {
    return *reinterpret_cast<OpenFile*>(file);
}
DiskState& of(sqlite3_vfs* vfs) {
    return *static_cast<DiskState*>(vfs->pAppData);
}
std::string directory_of(const std::string& path) {
    return std::filesystem::path(path).parent_path().string();
}

int close_file(sqlite3_file* file) {
    OpenFile& open = of(file);
    const auto scope = open.disk->gate->simulation();
    if (open.passing && !open.path.empty()) (void)open.disk->remove(open.path);
    open.~OpenFile();
    return SQLITE_OK;
}

int read_file(sqlite3_file* file, void* to, int size, sqlite3_int64 offset) {
    const OpenFile& open = of(file);
    if (!open.disk->runs) return SQLITE_IOERR_READ;
    const std::string& bytes = open.node->now;
    const auto wanted = static_cast<std::size_t>(size);
    const std::size_t from = std::min(static_cast<std::size_t>(offset), bytes.size());
    const std::size_t count = std::min(wanted, bytes.size() - from);
    std::memcpy(to, bytes.data() + from, count);
    if (count == wanted) return SQLITE_OK;
    std::memset(static_cast<char*>(to) + count, 0, wanted - count);
    return SQLITE_IOERR_SHORT_READ;
}

int write_file(sqlite3_file* file, const void* from, int size, sqlite3_int64 offset) {
    const OpenFile& open = of(file);
    const auto scope = open.disk->gate->simulation();
    std::string_view rest(static_cast<const char*>(from), static_cast<std::size_t>(size));
    auto at = static_cast<std::size_t>(offset);
    while (!rest.empty()) {
        const std::int64_t count = open.disk->write(*open.node, open.path, at, rest);
        if (count < 0) return count == -ENOSPC ? SQLITE_FULL : SQLITE_IOERR_WRITE;
        at += static_cast<std::size_t>(count);
        rest.remove_prefix(static_cast<std::size_t>(count));
    }
    return SQLITE_OK;
}

int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
    const OpenFile& open = of(file);
    const auto scope = open.disk->gate->simulation();
    return open.disk->truncate(*open.node, open.path, static_cast<std::size_t>(size)) == 0 ? SQLITE_OK : SQLITE_IOERR_TRUNCATE;
}

int sync_file(sqlite3_file* file, int /*flags*/) {
    OpenFile& open = of(file);
    const auto scope = open.disk->gate->simulation();
    if (open.disk->sync(*open.node, open.path) != 0) return SQLITE_IOERR_FSYNC;
    if (std::exchange(open.names_new, false))
        (void)open.disk->sync_directory(directory_of(open.path), open.disk->deviation == SqliteDeviation::journal_name_unnoticed);
    return SQLITE_OK;
}

int file_size(sqlite3_file* file, sqlite3_int64* size) {
    *size = static_cast<sqlite3_int64>(of(file).node->now.size());
    return of(file).disk->runs ? SQLITE_OK : SQLITE_IOERR_FSTAT;
}

// No locks: only one process, since Storage::hold() excludes a second.
int lock_file(sqlite3_file* /*file*/, int /*level*/) {
    return SQLITE_OK;
}
int check_lock(sqlite3_file* /*file*/, int* held) {
    *held = 0;
    return SQLITE_OK;
}
int control(sqlite3_file* /*file*/, int /*what*/, void* /*value*/) {
    return SQLITE_NOTFOUND;
}
// Both as in the unix VFS for an ordinary file system.
int sector_size(sqlite3_file* /*file*/) {
    return 4096;
}
int characteristics(sqlite3_file* /*file*/) {
    return SQLITE_IOCAP_POWERSAFE_OVERWRITE;
}

constexpr sqlite3_io_methods kMethods{.iVersion = 1,
                                      .xClose = close_file,
                                      .xRead = read_file,
                                      .xWrite = write_file,
                                      .xTruncate = truncate_file,
                                      .xSync = sync_file,
                                      .xFileSize = file_size,
                                      .xLock = lock_file,
                                      .xUnlock = lock_file,
                                      .xCheckReservedLock = check_lock,
                                      .xFileControl = control,
                                      .xSectorSize = sector_size,
                                      .xDeviceCharacteristics = characteristics,
                                      .xShmMap = nullptr,
                                      .xShmLock = nullptr,
                                      .xShmBarrier = nullptr,
                                      .xShmUnmap = nullptr,
                                      .xFetch = nullptr,
                                      .xUnfetch = nullptr};

int open_file(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* out_flags) {
    DiskState& disk = of(vfs);
    const auto scope = disk.gate->simulation();
    file->pMethods = nullptr;
    const std::string path = name == nullptr ? "" : name;
    NodePointer node = path.empty() ? std::make_shared<Node>() : disk.find(path);
    if (!node && (flags & SQLITE_OPEN_CREATE) != 0) {
        if (const int error = disk.make(path, false); error != 0) return error == ENOSPC ? SQLITE_FULL : SQLITE_CANTOPEN;
        node = disk.find(path);
    }
    if (!node || !disk.runs) return SQLITE_CANTOPEN;
    new (file) OpenFile{.base = {.pMethods = &kMethods},
                        .disk = &disk,
                        .node = std::move(node),
                        .path = path,
                        .names_new = (flags & SQLITE_OPEN_CREATE) != 0 && (flags & (SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_SUPER_JOURNAL)) != 0,
                        .passing = (flags & SQLITE_OPEN_DELETEONCLOSE) != 0};
    if (out_flags != nullptr) *out_flags = flags;
    return SQLITE_OK;
}

int delete_file(sqlite3_vfs* vfs, const char* name, int sync_directory) {
    DiskState& disk = of(vfs);
    const auto scope = disk.gate->simulation();
    if (const int error = disk.remove(name); error != 0) return error == ENOENT ? SQLITE_IOERR_DELETE_NOENT : SQLITE_IOERR_DELETE;
    return sync_directory != 0 && disk.deviation != SqliteDeviation::removal_not_synced && disk.sync_directory(directory_of(name)) != 0
               ? SQLITE_IOERR_DIR_FSYNC
               : SQLITE_OK;
}

int access_file(sqlite3_vfs* vfs, const char* name, int how, int* result) {
    const auto scope = of(vfs).gate->simulation();
    const NodePointer node = of(vfs).find(name);
    *result = node && (how != SQLITE_ACCESS_EXISTS || node->directory || !node->now.empty()) ? 1 : 0;
    return SQLITE_OK;
}

int full_path(sqlite3_vfs* /*vfs*/, const char* name, int size, char* out) {
    sqlite3_snprintf(size, out, "%s", name);
    return SQLITE_OK;
}

int randomness(sqlite3_vfs* /*vfs*/, int size, char* out) {
    std::memset(out, 1, static_cast<std::size_t>(size));
    return size;
}
int sleep_us(sqlite3_vfs* /*vfs*/, int us) {
    return us;
}
int current_time(sqlite3_vfs* /*vfs*/, double* julian_day) {
    *julian_day = 2'461'000.5;
    return SQLITE_OK;
}
int last_error(sqlite3_vfs* /*vfs*/, int /*size*/, char* /*out*/) {
    return 0;
}

}  // namespace

struct DiskVfs::Registered {
    sqlite3_vfs vfs{};
};

DiskVfs::DiskVfs(DiskState& state, std::string name) : name_(std::move(name)), registered_(std::make_unique<Registered>()) {
    constexpr int kLongestPath = 512;
    sqlite3_vfs& vfs = registered_->vfs;
    vfs.iVersion = 1;
    vfs.szOsFile = sizeof(OpenFile);
    vfs.mxPathname = kLongestPath;
    vfs.zName = name_.c_str();
    vfs.pAppData = &state;
    vfs.xOpen = open_file;
    vfs.xDelete = delete_file;
    vfs.xAccess = access_file;
    vfs.xFullPathname = full_path;
    vfs.xRandomness = randomness;
    vfs.xSleep = sleep_us;
    vfs.xCurrentTime = current_time;
    vfs.xGetLastError = last_error;
    sqlite3_vfs_register(&vfs, 0);
    // SQLite's random numbers are part of a journal's bytes: they must be the same in every run.
    sqlite3_test_control(SQLITE_TESTCTRL_PRNG_SEED, 1, nullptr);
}

DiskVfs::~DiskVfs() {
    sqlite3_test_control(SQLITE_TESTCTRL_PRNG_SEED, 0, nullptr);
    sqlite3_vfs_unregister(&registered_->vfs);
}

}  // namespace plant_sim::simulation
