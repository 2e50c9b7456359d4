/// The page's own files, out of this room.
#pragma once

namespace rig::panel {

extern const char* const kIndexHtml;
extern const char* const kPanelCss;
extern const char* const kChartsJs;
extern const char* const kPanelJs;

}  // namespace rig::panel
