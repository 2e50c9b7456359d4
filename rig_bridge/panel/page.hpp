/// The page's files, from this folder.
#pragma once

namespace rig::panel {

/// Directory of the Debian package libjs-dygraphs.
inline constexpr const char* kChartsLibrary = "/usr/share/javascript/dygraphs";

extern const char* const kIndexHtml;
extern const char* const kPanelCss;
extern const char* const kChartsJs;
extern const char* const kPanelJs;

}  // namespace rig::panel
