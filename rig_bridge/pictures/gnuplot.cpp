#include "rig_bridge/pictures/gnuplot.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "firmware/host/settings/atomic_file.hpp"

namespace pictures {

namespace {

namespace fs = std::filesystem;

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

fs::path aside(const fs::path& picture) {
    return picture.string() + ".part";
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

void run_gnuplot(const std::filesystem::path& picture, int width, int height, const std::string& commands) {
    const fs::path png = picture.extension() == ".svg" ? fs::path(picture).replace_extension(".png") : picture;
    // A file, not a pipe: where gnuplot is missing or ends early, a pipe's reader is gone, and SIGPIPE would end this program.
    const fs::path script = png.string() + ".gnuplot";
    const std::array<std::pair<fs::path, const char*>, 2> pictures{
        {{png, "pngcairo"}, {fs::path(png).replace_extension(".svg"), "svg background '#ffffff'"}}};
    std::string all;
    for (const auto& [file, terminal] : pictures)
        all += fmt::format(
            "reset\nset terminal {} size {},{} font 'sans,11' enhanced\nset output {}\nset grid xtics ytics lt 1 lw 0.8 lc rgb '#d0d7de'\nset border "
            "lc rgb '#555555'\n{}\n"
            "set output\n",
            terminal, width, height, gnuplot_quoted(aside(file).string()), commands);
    settings::write_file(script, all);
    std::FILE* gnuplot = ::popen(("gnuplot " + shell_quoted(script.string()) + " 2>&1").c_str(), "r");
    if (gnuplot == nullptr) throw std::runtime_error("cannot start gnuplot");
    std::string output;
    for (int c = std::fgetc(gnuplot); c != EOF; c = std::fgetc(gnuplot)) output.push_back(static_cast<char>(c));
    const int status = ::pclose(gnuplot);
    std::error_code ignored;
    fs::remove(script, ignored);
    for (const auto& [file, terminal] : pictures) {
        if (status == 0)
            fs::rename(aside(file), file);
        else
            fs::remove(aside(file), ignored);
    }
    if (status != 0) throw std::runtime_error("gnuplot failed (is gnuplot-nox installed?): " + output);
}

}  // namespace pictures
