/// Origin of a learnt file. Programs repeat it in the results that they derive from the file.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace wear {

inline constexpr const char* kUnknownOrigin = "unknown origin";

/// Whether a text is a valid origin: it begins with "measured" or "made up" (by which law or simulator, on which rig), or is kUnknownOrigin.
[[nodiscard]] bool is_origin(std::string_view text);

/// For people, after "a brake" or "brakes": "measured on rig 7", "of unknown origin".
[[nodiscard]] std::string origin_phrase(const std::string& origin);

struct Provenance {
    std::string origin = kUnknownOrigin;
    std::size_t lives = 1;  ///< number of brakes that it was learnt from
    bool operator==(const Provenance&) const = default;

    [[nodiscard]] bool made_up() const { return origin.starts_with("made up"); }
    /// "made up by the law of X, 40 lives".
    [[nodiscard]] std::string sentence() const;
};

/// Origin of several: their common one; if they differ, the least trustworthy: made up before unknown before measured.
[[nodiscard]] std::string common_origin(const std::vector<std::string>& origins);

}  // namespace wear
