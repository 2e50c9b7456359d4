/// Style sheet and script of the report's page, from the files of this folder.
#pragma once

namespace paper {

extern const char* const kReportCss;
extern const char* const kReportJs;

}  // namespace paper
