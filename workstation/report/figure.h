// One figure: gnuplot commands with their data, and the words that go with them. Drawn as a
// stand-alone SVG file, then prepared for a page that holds several of them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/report/palette.h"

namespace bess {

struct Figure {
  std::string name;     ///< file stem and prefix of its ids
  std::string title;    ///< heading on the page
  std::string alt;      ///< what is to be seen, for those who cannot see it
  std::string caption;  ///< what it means, in one or two sentences with numbers
  int width_px = 880;
  int height_px = 420;
  std::string commands;  ///< gnuplot, without terminal and output
};

/// Writes `folder`/`name`.svg, beside and renamed. Throws UserError without gnuplot.
void draw_figure(const Figure& figure, const std::filesystem::path& folder);

/// The SVG element alone: its ids made unique, its colours made variables of the page, with title
/// and description for screen readers.
std::string inline_svg(std::string_view svg, const Figure& figure);

/// gnuplot's `$name << EOD` with one line per row.
std::string data_block(std::string_view name, const std::vector<std::string>& rows);
/// `rgb '#0072b2'`
std::string rgb(const Colour& colour);

}  // namespace bess
