/// The report as one HTML page that needs nothing else: pictures, data and scripts in it, nothing fetched. Reads on paper.
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

/// What a comparison came to.
struct Compared {
    const Comparison* what = nullptr;
    std::optional<double> ours;  ///< none: not to be had
    std::string why;             ///< where it is not
};

/// The number in a JSON text at `path`: "/measured/torque_Nm/mean", "/rows/2/mean" (from 0), "/references[reference=0.24]/mean" (the first
/// element of an array whose member is that number, to 1e-9, or that text), "/components/#" (how many an array has). Throws
/// std::runtime_error saying what is not there.
[[nodiscard]] double value_at(std::string_view json, std::string_view path);

/// In the order of the contents.
[[nodiscard]] std::vector<Compared> compared(const std::vector<SectionResult>& results,
                                             const std::filesystem::path& config = settings::config_directory());

struct PageHead {
    std::string version;
    std::string config_hash;
    std::string command;  ///< that made the page
    bool quick = false;
    std::filesystem::path charts_library = rig::panel::kChartsLibrary;  ///< without it the page has pictures alone
};

[[nodiscard]] std::string to_html(const Contents& contents, const std::vector<SectionResult>& results, const std::vector<Compared>& rows,
                                  const PageHead& head);
[[nodiscard]] std::string to_json(const std::vector<SectionResult>& results, const std::vector<Compared>& rows, const PageHead& head);

/// RFC 4648.
[[nodiscard]] std::string base64(std::string_view bytes);
/// Safe as HTML text and in attributes; bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace paper
