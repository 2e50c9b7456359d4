#include <fcntl.h>
#include <matio.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <stdexcept>

#include "firmware/host/settings/file_descriptor.hpp"
#include "firmware/host/settings/number_in.hpp"
#include "rig_bridge/replay/mat_structure.hpp"
#include "rig_bridge/replay/recording.hpp"

namespace rig::replay {

namespace {

class MappedFile {
  public:
    explicit MappedFile(const std::filesystem::path& path) {
        const settings::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
        struct stat status {};
        if (!file.is_open() || ::fstat(file.get(), &status) != 0)
            throw std::runtime_error(path.string() + ": cannot be read: " + std::strerror(errno));
        if (!S_ISREG(status.st_mode)) throw std::runtime_error(path.string() + ": is no file");
        size_ = static_cast<std::size_t>(status.st_size);
        if (size_ == 0) return;  // an empty file cannot be mapped
        void* const begin = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file.get(), 0);
        if (begin == MAP_FAILED) throw std::runtime_error(path.string() + ": cannot be read: " + std::strerror(errno));
        begin_ = begin;
    }
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;
    ~MappedFile() {
        if (begin_ != nullptr) ::munmap(begin_, size_);
    }
    [[nodiscard]] std::span<const unsigned char> bytes() const { return {static_cast<const unsigned char*>(begin_), size_}; }

  private:
    void* begin_ = nullptr;
    std::size_t size_ = 0;
};

struct CloseFile {
    void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
    void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

template <typename T>
void copy(const matvar_t& variable, std::size_t from, std::size_t rows, std::vector<double>& out) {
    const T* const data = static_cast<const T*>(variable.data) + from;
    out.assign(data, data + rows);
}

class MatRecording final : public Recording {
  public:
    MatRecording(const std::filesystem::path& path, const std::vector<std::string>& wanted) : name_(path.string()), wanted_(wanted) {
        check_mat_structure(name_, MappedFile(path).bytes());
        file_.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
        if (!file_) throw std::runtime_error(name_ + kNoMat);
        for (const std::string& column : wanted_) columns_.push_back(load(column));
        for (std::size_t i = 0; i < columns_.size(); ++i)
            if (columns_[i].size() != columns_[0].size())
                throw std::runtime_error(name_ + ": " + wanted_[i] + " has " + std::to_string(columns_[i].size()) + " values, " + wanted_[0] +
                                         " has " + std::to_string(columns_[0].size()));
        file_.reset();
    }

    bool next(RecordedRow& row) override {
        if (columns_.empty() || at_ >= columns_[0].size()) return false;
        row.row = at_ + 1;
        row.values.clear();
        row.unreadable.clear();
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            row.values.push_back(columns_[i][at_]);
            if (!std::isfinite(columns_[i][at_])) row.unreadable.push_back("variable " + wanted_[i] + ": no number");
        }
        ++at_;
        return true;
    }

    [[nodiscard]] std::string stated_unit(std::size_t) const override { return {}; }
    [[nodiscard]] double share() const override {
        return columns_.empty() ? 1.0 : static_cast<double>(at_) / static_cast<double>(columns_[0].size());
    }

  private:
    /// `column`: "p", "bench.p", "data:3".
    std::vector<double> load(const std::string& column) {
        const auto colon = column.find(':');
        const auto dot = column.find('.');
        const std::size_t number = colon == std::string::npos ? 1 : settings::number_in<std::size_t>(column.substr(colon + 1)).value_or(0);
        if (number == 0) throw std::runtime_error(name_ + ": '" + column + "': expected a column number from 1 after the colon");
        const std::string variable = column.substr(0, std::min(dot, colon));
        const std::unique_ptr<matvar_t, FreeVariable> whole(Mat_VarRead(file_.get(), variable.c_str()));
        const matvar_t* found = whole.get();
        if (found != nullptr && dot != std::string::npos) {
            const auto length = colon == std::string::npos ? colon : colon - dot - 1;
            found = found->class_type == MAT_C_STRUCT ? Mat_VarGetStructFieldByName(whole.get(), column.substr(dot + 1, length).c_str(), 0) : nullptr;
        }
        if (found == nullptr) throw std::runtime_error(name_ + ": no variable '" + column + "'; there are: " + variables());
        return values(column, *found, number, colon == std::string::npos);
    }

    std::vector<double> values(const std::string& column, const matvar_t& v, std::size_t number, bool whole) const {
        if (v.rank != 2 || v.isComplex != 0 || v.data == nullptr) throw std::runtime_error(name_ + ": '" + column + "' is no real vector or matrix");
        const bool row_vector = v.dims[0] == 1 && whole;
        const std::size_t rows = row_vector ? v.dims[1] : v.dims[0];
        if (whole && v.dims[0] != 1 && v.dims[1] != 1)
            throw std::runtime_error(name_ + ": '" + column + "' has " + std::to_string(v.dims[1]) + " columns; choose one, like " + column + ":2");
        if (number > (row_vector ? 1 : v.dims[1]))
            throw std::runtime_error(name_ + ": '" + column + "': there are only " + std::to_string(v.dims[1]) + " columns");
        const std::size_t from = (number - 1) * rows;
        std::vector<double> out;
        switch (v.class_type) {
            case MAT_C_DOUBLE:
                copy<double>(v, from, rows, out);
                break;
            case MAT_C_SINGLE:
                copy<float>(v, from, rows, out);
                break;
            case MAT_C_INT32:
                copy<std::int32_t>(v, from, rows, out);
                break;
            case MAT_C_UINT32:
                copy<std::uint32_t>(v, from, rows, out);
                break;
            case MAT_C_INT16:
                copy<std::int16_t>(v, from, rows, out);
                break;
            case MAT_C_UINT16:
                copy<std::uint16_t>(v, from, rows, out);
                break;
            case MAT_C_INT8:
                copy<std::int8_t>(v, from, rows, out);
                break;
            case MAT_C_UINT8:
                copy<std::uint8_t>(v, from, rows, out);
                break;
            default:
                throw std::runtime_error(name_ + ": '" + column + "' holds no numbers");
        }
        return out;
    }

    [[nodiscard]] std::string variables() const {
        std::size_t count = 0;
        char* const* const names = Mat_GetDir(file_.get(), &count);
        std::string list;
        for (std::size_t i = 0; i < count; ++i) list.append(list.empty() ? "" : ", ").append(names[i]);
        return list;
    }

    std::string name_;
    std::vector<std::string> wanted_;
    std::unique_ptr<mat_t, CloseFile> file_;
    std::vector<std::vector<double>> columns_;
    std::size_t at_ = 0;
};

}  // namespace

std::unique_ptr<Recording> open_mat(const std::filesystem::path& file, const std::vector<std::string>& wanted) {
    return std::make_unique<MatRecording>(file, wanted);
}

}  // namespace rig::replay
