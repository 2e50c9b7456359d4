/// Rows of a table in CSV as people's tools write it: fields between commas, blanks around them left out; a field in
/// quotes may hold commas, and its doubled quotes stay doubled. Empty lines, lines that begin with #,
/// a byte-order mark and carriage returns do not count.
///
///     for (CsvRows rows(csv); rows.next();) use(rows.fields(), rows.line());
///
/// Fields are views into the text, which must outlive them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wear {

class CsvRows {
  public:
    explicit CsvRows(std::string_view csv);

    /// To the next row, the header first. False at the end.
    [[nodiscard]] bool next();
    [[nodiscard]] const std::vector<std::string_view>& fields() const { return fields_; }
    [[nodiscard]] unsigned line() const { return line_; }  ///< of the row, from 1

  private:
    std::string_view rest_;
    std::vector<std::string_view> fields_;
    unsigned line_ = 0;
};

/// A field as number. Throws settings::Error with file, line and column where it is no finite number.
[[nodiscard]] double csv_number(const std::string& file, unsigned line, std::string_view column, std::string_view field);

}  // namespace wear
