#include "rig_bridge/replay/table_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <matio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "firmware/host/settings/file_descriptor.hpp"

namespace rig::replay {

namespace {

class CsvWriter final : public TableWriter {
  public:
    CsvWriter(const std::filesystem::path& path, const std::vector<std::string>& columns) : file_(path), out_(file_.part(), std::ios::binary) {
        out_ << fmt::format("{}\n", fmt::join(columns, ","));
        check();
    }

    void row(const std::vector<double>& values) override {
        line_.clear();
        // Times in microseconds, as in a log; the other values had 32 bits.
        fmt::format_to(std::back_inserter(line_), "{:.6f}", values.front());
        for (std::size_t i = 1; i < values.size(); ++i) fmt::format_to(std::back_inserter(line_), ",{:.7g}", values[i]);
        line_.push_back('\n');
        out_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
        check();
    }

    void finish() override {
        out_.close();
        check();
        file_.commit();
    }

  private:
    void check() const {
        if (!out_) throw std::runtime_error(file_.name() + ": cannot be written: " + std::strerror(errno));
    }

    PartFile file_;
    std::ofstream out_;
    fmt::memory_buffer line_;
};

struct CloseMat {
    void operator()(mat_t* file) const { Mat_Close(file); }
};

class MatWriter final : public TableWriter {
  public:
    MatWriter(const std::filesystem::path& path, std::vector<std::string> columns)
        : file_(path), columns_(std::move(columns)), blocks_(columns_.size()), mat_(Mat_CreateVer(file_.part().c_str(), nullptr, MAT_FT_MAT73)) {
        if (!mat_) throw std::runtime_error(file_.name() + ": cannot be written");
    }

    void row(const std::vector<double>& values) override {
        constexpr std::size_t kRowsInMemory = 16384;
        for (std::size_t i = 0; i < blocks_.size(); ++i) blocks_[i].push_back(values[i]);
        if (blocks_.front().size() == kRowsInMemory) flush();
    }

    void finish() override {
        if (!blocks_.front().empty()) flush();
        if (Mat_Close(mat_.release()) != 0) fail();
        file_.commit();
    }

  private:
    void flush() {
        for (std::size_t i = 0; i < blocks_.size(); ++i) {
            std::array<std::size_t, 2> size{blocks_[i].size(), 1};
            matvar_t* const column =
                Mat_VarCreate(columns_[i].c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), blocks_[i].data(), MAT_F_DONT_COPY_DATA);
            const int status = Mat_VarWriteAppend(mat_.get(), column, MAT_COMPRESSION_ZLIB, 1);
            Mat_VarFree(column);
            if (status != 0) fail();
            blocks_[i].clear();
        }
    }
    [[noreturn]] void fail() const { throw std::runtime_error(file_.name() + ": cannot be written; is the disk full?"); }

    PartFile file_;
    std::vector<std::string> columns_;
    std::vector<std::vector<double>> blocks_;
    std::unique_ptr<mat_t, CloseMat> mat_;
};

}  // namespace

PartFile::PartFile(const std::filesystem::path& path) : name_(path.string()), part_(path.string() + ".part") {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
}

PartFile::~PartFile() {
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

void PartFile::commit() {
    const settings::FileDescriptor file(::open(part_.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.is_open() || ::fsync(file.get()) != 0)
        throw std::filesystem::filesystem_error("cannot be stored", part_, std::error_code(errno, std::generic_category()));
    std::filesystem::rename(part_, name_);
}

std::unique_ptr<TableWriter> csv_writer(const std::filesystem::path& path, const std::vector<std::string>& columns) {
    return std::make_unique<CsvWriter>(path, columns);
}

std::unique_ptr<TableWriter> mat_writer(const std::filesystem::path& path, const std::vector<std::string>& columns) {
    return std::make_unique<MatWriter>(path, columns);
}

}  // namespace rig::replay
