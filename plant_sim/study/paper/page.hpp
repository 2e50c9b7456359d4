/// The report as one self-contained HTML page, with pictures, data and scripts embedded. It can be printed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/settings/config_directory.hpp"
#include "plant_sim/study/paper/run.hpp"
#include "rig_bridge/panel/page.hpp"

namespace paper {

/// Result of a comparison.
struct Compared {
    const Comparison* what = nullptr;
    std::optional<double> ours;  ///< none: not available
    std::string why;             ///< reason, if it is not
};

/// The number at `path` in a JSON text: "/measured/torque_Nm/mean", "/rows/2/mean" (from 0), "/references[reference=0.24]/mean" (the first element of
/// an array with a member of that value, to 1e-9, or of that text), "/components/#" (the size of an array). Throws std::runtime_error naming what is
/// missing.
[[nodiscard]] double value_at(std::string_view json, std::string_view path);

/// Results in the order of the contents.
[[nodiscard]] std::vector<Compared> compared(const std::vector<SectionResult>& results,
                                             const std::filesystem::path& config = settings::config_directory());

struct PageHead {
    std::string version;
    std::string config_hash;
    std::string command;  ///< that makes the page
    bool quick = false;
    std::filesystem::path charts_library = rig::panel::kChartsLibrary;  ///< if it is missing, the page has only pictures
};

[[nodiscard]] std::string to_html(const Contents& contents, const std::vector<SectionResult>& results, const std::vector<Compared>& rows,
                                  const PageHead& head);
[[nodiscard]] std::string to_json(const std::vector<SectionResult>& results, const std::vector<Compared>& rows, const PageHead& head);

/// RFC 4648.
[[nodiscard]] std::string base64(std::string_view bytes);
/// Escapes text for HTML and its attributes; bytes that are not UTF-8 become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace paper
