/// What a command printed, as HTML: tables of Markdown (lines that begin with |) become tables, all else stays as it stands.
#pragma once

#include <string>
#include <string_view>

namespace paper {

[[nodiscard]] std::string output_html(std::string_view output);

}  // namespace paper
