#include "rig_bridge/pictures/gnuplot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace pictures {

namespace {

std::string shell_quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'')
            out += "'\\''";
        else
            out.push_back(c);
    }
    out.push_back('\'');
    return out;
}

}  // namespace

std::string gnuplot_quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) {
        out.push_back(c);
        if (c == '\'') out.push_back(c);
    }
    out.push_back('\'');
    return out;
}

std::string gnuplot_block(std::string_view name, std::string_view rows) {
    return fmt::format("${} << EOD\n{}EOD\n", name, rows.empty() ? "NaN NaN NaN NaN NaN NaN\n" : rows);
}

void run_gnuplot(const std::filesystem::path& png, int width, int height, const std::string& commands) {
    const std::filesystem::path aside = png.string() + ".part";
    const std::filesystem::path says = png.string() + ".gnuplot-says";
    const std::string all = fmt::format(
        "set terminal pngcairo size {},{} font 'sans,11' enhanced\nset output {}\nset grid lc rgb '#dddddd'\nset border lc rgb '#555555'\n{}", width,
        height, gnuplot_quoted(aside.string()), commands);
    std::FILE* gnuplot = ::popen(("gnuplot >" + shell_quoted(says.string()) + " 2>&1").c_str(), "w");
    if (gnuplot == nullptr) throw std::runtime_error("cannot start gnuplot");
    std::fwrite(all.data(), 1, all.size(), gnuplot);
    const int status = ::pclose(gnuplot);
    std::ifstream said(says);
    const std::string output((std::istreambuf_iterator<char>(said)), std::istreambuf_iterator<char>());
    std::error_code ignored;
    std::filesystem::remove(says, ignored);
    if (status != 0) {
        std::filesystem::remove(aside, ignored);
        throw std::runtime_error("gnuplot failed (is gnuplot-nox installed?): " + output);
    }
    std::filesystem::rename(aside, png);
}

}  // namespace pictures
