#include "firmware/can/dbc_cursor.hpp"

#include <charconv>
#include <cmath>
#include <utility>

#include "firmware/host/settings/error.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace antiskid::can {

namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

bool ends_word(char c) {
    return is_blank(c) || c == '\n' || std::string_view(":;,\"()[]|@").find(c) != std::string_view::npos;
}

}  // namespace

DbcCursor::DbcCursor(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text_.starts_with(kByteOrderMark)) position_ = kByteOrderMark.size();
}

void DbcCursor::advance() {
    if (text_[position_] == '\n') ++line_;
    ++position_;
}

void DbcCursor::skip_blanks() {
    while (!at_end() && is_blank(text_[position_])) ++position_;
}

void DbcCursor::skip_space() {
    while (!at_end() && (is_blank(text_[position_]) || text_[position_] == '\n')) advance();
}

bool DbcCursor::at_line_end() {
    skip_blanks();
    return at_end() || text_[position_] == '\n';
}

char DbcCursor::peek() {
    skip_space();
    return at_end() ? '\0' : text_[position_];
}

void DbcCursor::skip_line() {
    while (!at_end() && text_[position_] != '\n') {
        if (text_[position_] == '"') {
            static_cast<void>(quoted("string"));
        } else {
            advance();
        }
    }
    if (!at_end()) advance();
}

void DbcCursor::skip_statement() {
    while (!at_end() && text_[position_] != ';') {
        if (text_[position_] == '"') {
            static_cast<void>(quoted("string"));
        } else {
            advance();
        }
    }
    expect(';', "at the end of the statement");
}

std::string_view DbcCursor::word(std::string_view what) {
    skip_blanks();
    const std::size_t start = position_;
    while (!at_end() && !ends_word(text_[position_])) ++position_;
    if (position_ == start) fail("expected " + std::string(what) + ", got " + found());
    return text_.substr(start, position_ - start);
}

std::uint64_t DbcCursor::natural(std::string_view what, std::uint64_t max) {
    skip_blanks();
    const std::string_view rest = text_.substr(position_);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{} || value > max) {
        fail("expected " + std::string(what) + ", a whole number from 0 to " + std::to_string(max) + ", got " + found());
    }
    position_ += static_cast<std::size_t>(end - rest.data());
    return value;
}

double DbcCursor::number(std::string_view what) {
    skip_space();
    const std::size_t plus = !at_end() && text_[position_] == '+' ? 1 : 0;
    const std::string_view rest = text_.substr(position_ + plus);
    double value = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) {
        fail("expected " + std::string(what) + ", a number, got " + found());
    }
    position_ += plus + static_cast<std::size_t>(end - rest.data());
    return value;
}

std::string DbcCursor::quoted(std::string_view what) {
    skip_space();
    if (at_end() || text_[position_] != '"') fail("expected " + std::string(what) + " in double quotes, got " + found());
    const std::uint32_t opened = line_;
    advance();
    std::string out;
    while (!at_end() && text_[position_] != '"') {
        if (text_[position_] == '\\' && position_ + 1 < text_.size() && text_[position_ + 1] == '"') advance();
        out += text_[position_];
        advance();
    }
    if (at_end()) throw settings::Error(file_, opened, "", "the string that opens here is never closed");
    advance();
    return out;
}

void DbcCursor::expect(char wanted, std::string_view where) {
    skip_blanks();
    if (at_end() || text_[position_] != wanted) {
        fail(std::string("expected '") + wanted + "' " + std::string(where) + ", got " + found());
    }
    advance();
}

char DbcCursor::sign(std::string_view what) {
    if (at_end() || (text_[position_] != '+' && text_[position_] != '-')) {
        fail("expected " + std::string(what) + ", + (unsigned) or - (signed), got " + found());
    }
    return text_[position_++];
}

void DbcCursor::fail(std::string message) const {
    throw settings::Error(file_, line_, "", std::move(message));
}

std::string DbcCursor::found() const {
    if (at_end()) return "the end of the file";
    if (text_[position_] == '\n' || text_[position_] == '\r') return "the end of the line";
    std::size_t end = position_ + 1;
    while (end < text_.size() && end - position_ < 20 && !is_blank(text_[end]) && text_[end] != '\n') ++end;
    std::string quote(1, '\'');
    quote += settings::printable(text_.substr(position_, end - position_));
    return quote += '\'';
}

}  // namespace antiskid::can
