/// The page's own files, out of this room.
#pragma once

namespace rig::panel {

/// Of the package libjs-dygraphs.
inline constexpr const char* kChartsLibrary = "/usr/share/javascript/dygraphs";

extern const char* const kIndexHtml;
extern const char* const kPanelCss;
extern const char* const kChartsJs;
extern const char* const kPanelJs;

}  // namespace rig::panel
