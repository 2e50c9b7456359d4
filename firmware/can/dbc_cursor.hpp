/// Reads tokens from the text of a DBC file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace antiskid::can {

/// Every read skips blanks first, and throws settings::Error with file and line if the text is not what was asked for.
class DbcCursor {
  public:
    DbcCursor(std::string_view text, std::string file);

    /// skip_blanks() stays within the line; skip_space() also skips line ends.
    void skip_blanks();
    void skip_space();
    [[nodiscard]] bool at_end() const { return position_ == text_.size(); }
    /// At a line end or the end of the text, after skip_blanks().
    [[nodiscard]] bool at_line_end();
    /// The next character after white space and line ends, NUL at the end.
    [[nodiscard]] char peek();
    [[nodiscard]] std::uint32_t line() const { return line_; }

    /// Moves to the start of the next line; a line end inside a string does not count.
    void skip_line();
    /// Moves past the next semicolon that is not inside a string.
    void skip_statement();

    /// Up to white space or one of : ; , " ( ) [ ] | @
    [[nodiscard]] std::string_view word(std::string_view what);
    [[nodiscard]] std::uint64_t natural(std::string_view what, std::uint64_t max);
    [[nodiscard]] double number(std::string_view what);
    /// Text between double quotes, which may contain line ends; \" is a quote.
    [[nodiscard]] std::string quoted(std::string_view what);
    void expect(char wanted, std::string_view where);
    /// '+' or '-' right here.
    [[nodiscard]] char sign(std::string_view what);

    [[noreturn]] void fail(std::string message) const;

  private:
    void advance();
    [[nodiscard]] std::string found() const;

    std::string_view text_;
    std::string file_;
    std::size_t position_ = 0;
    std::uint32_t line_ = 1;
};

}  // namespace antiskid::can
