#include "firmware/host/settings/atomic_file.hpp"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <iterator>

#include "tests/settings/refusal.hpp"

namespace fs = std::filesystem;

namespace {

std::size_t entries(const fs::path& directory) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

std::string rejected(const fs::path& path, std::string_view bytes = "x") {
    const auto error = rejection_of([&] {
        settings::write_file(path, bytes);
        return 0;
    });
    CHECK(error.file() == path.string());
    return error.message();
}

/// No file of this process can grow beyond `bytes` while it lives: what a full disk does, without one.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        if (::getrlimit(RLIMIT_FSIZE, &before_) != 0) throw std::runtime_error("getrlimit");
        rlimit limit = before_;
        limit.rlim_cur = bytes;
        if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) throw std::runtime_error("setrlimit");
    }
    ~FileSizeLimit() {
        static_cast<void>(::setrlimit(RLIMIT_FSIZE, &before_));
        static_cast<void>(std::signal(SIGXFSZ, handler_));
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  private:
    rlimit before_{};
    void (*handler_)(int);
};

}  // namespace

TEST_CASE("a file is written whole, in directories that need not exist", "[CFG-023]") {
    const TemporaryDirectory directory;
    const auto path = directory / "out/demo/result.json";
    std::string bytes;
    for (int i = 0; i < 300000; ++i) bytes += static_cast<char>(i % 251);
    settings::write_file(path, bytes);
    CHECK(content_of(path) == bytes);
    settings::write_file(path, "");
    CHECK(content_of(path).empty());
    CHECK(entries(path.parent_path()) == 1);
}

TEST_CASE("the name may be relative or as long as the file system allows", "[CFG-023]") {
    const TemporaryDirectory directory;
    const auto longest = directory / std::string(255, 'n');
    settings::write_file(longest, "x");
    CHECK(content_of(longest) == "x");

    const auto before = fs::current_path();
    fs::current_path(directory.path());
    settings::write_file("relative", "y");
    fs::current_path(before);
    CHECK(content_of(directory / "relative") == "y");
}

TEST_CASE("permissions follow the umask", "[CFG-023]") {
    const TemporaryDirectory directory;
    const auto before = ::umask(027);
    settings::write_file(directory / "file", "x");
    ::umask(before);
    CHECK(fs::status(directory / "file").permissions() == static_cast<fs::perms>(0640));
}

TEST_CASE("a full disk leaves the old file and nothing beside it", "[CFG-023]") {
    const TemporaryDirectory directory;
    const auto path = directory / "result.json";
    settings::write_file(path, "old");
    std::string message;
    {
        const FileSizeLimit limit(4096);
        message = rejected(path, std::string(100000, 'x'));
    }
    CHECK(message == "cannot be written: File too large");
    CHECK(content_of(path) == "old");
    CHECK(entries(directory.path()) == 1);
}

TEST_CASE("readers and a killed writer never see half a file", "[CFG-023]") {
    const TemporaryDirectory directory;
    const auto path = directory / "state";
    const std::string a(400000, 'a');
    const std::string b(400000, 'b');
    settings::write_file(path, a);
    const auto child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        try {
            while (true) {
                settings::write_file(path, b);
                settings::write_file(path, a);
            }
        } catch (...) {
            ::_exit(1);
        }
    }
    int seen_b = 0;
    bool whole = true;
    for (int reading = 0; reading < 300 || (seen_b == 0 && reading < 1000000); ++reading) {
        const auto content = content_of(path);
        whole = whole && (content == a || content == b);
        seen_b += content == b ? 1 : 0;
    }
    ::kill(child, SIGKILL);
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    CHECK(whole);
    CHECK(seen_b > 0);
    const auto last = content_of(path);
    CHECK((last == a || last == b));
}

TEST_CASE("what is no regular file is neither written nor replaced", "[CFG-023]") {
    const TemporaryDirectory directory;
    const auto pipe = directory / "pipe";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(rejected(pipe) == "is a device, pipe or socket; results are only written to regular files");
    CHECK(fs::is_fifo(pipe));
    CHECK(rejected(directory.path()) == "is a directory, not a file");
    CHECK(rejected(directory / "new/") == "is not the name of a file");
    CHECK(rejected("") == "is not the name of a file");
    put(directory / "file", "x");
    CHECK_THAT(rejected(directory / "file/below"), ContainsSubstring("Not a directory"));
    CHECK_THAT(rejected(directory / "file/below/deeper"), ContainsSubstring("Not a directory"));
    CHECK_THAT(rejected(directory / std::string(256, 'n')), ContainsSubstring("File name too long"));
    CHECK_THAT(rejected("/proc/absent/file"), ContainsSubstring("No such file or directory"));
    CHECK(entries(directory.path()) == 2);
}

TEST_CASE("a symbolic link stays and its file is written", "[CFG-023]") {
    const TemporaryDirectory directory;
    fs::create_directory(directory / "elsewhere");
    put(directory / "elsewhere/file", "old");
    fs::create_symlink("elsewhere/file", directory / "link");
    settings::write_file(directory / "link", "new");
    CHECK(fs::is_symlink(directory / "link"));
    CHECK(content_of(directory / "elsewhere/file") == "new");
    CHECK(entries(directory / "elsewhere") == 1);
}
