// Plots with gnuplot: commands with inline data through a pipe.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace bess {

/// Text in gnuplot's single quotes.
std::string gnuplot_quoted(std::string_view text);

/// Draws `path`. `script` returns the commands for a given output file, which is gnuplot's standard
/// output, so that a failure leaves no file. Throws UserError if gnuplot is missing or fails.
void draw_with_gnuplot(const std::filesystem::path& path,
                       const std::function<std::string(const std::filesystem::path&)>& script);

}  // namespace bess
