// The one way this program draws: gnuplot, fed commands with inline data through a pipe.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace bess {

/// Text in gnuplot's single quotes.
std::string gnuplot_quoted(std::string_view text);

/// Draws `path`. `script` returns the commands for the output file that it is given, which is
/// gnuplot's standard output: a failure, or the end of this program, leaves nothing behind. Throws
/// UserError when gnuplot is missing or fails.
void draw_with_gnuplot(const std::filesystem::path& path,
                       const std::function<std::string(const std::filesystem::path&)>& script);

}  // namespace bess
