/// The page's own files, out of this room.
#pragma once

namespace paper {

extern const char* const kReportCss;
extern const char* const kReportJs;

}  // namespace paper
