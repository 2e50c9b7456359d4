/// Converts a command's output to HTML: Markdown tables (lines that begin with |) become tables, all else stays preformatted.
#pragma once

#include <string>
#include <string_view>

namespace paper {

[[nodiscard]] std::string output_html(std::string_view output);

}  // namespace paper
