// One figure: gnuplot commands with their data, and the words that go with them. Drawn as a
// stand-alone SVG file, then prepared for a page that holds several of them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/base/palette.h"
#include "workstation/report/figures/picture_table.h"

namespace bess {

struct Figure {
  std::string name;     ///< file stem and prefix of its ids
  std::string title;    ///< heading on the page
  std::string alt;      ///< what is to be seen, for those who cannot see it
  std::string caption;  ///< what it means, in one or two sentences with numbers
  int width_px = 880;
  int height_px = 420;
  std::string commands;  ///< gnuplot, without terminal and output
  /// What is drawn; no columns where a table of the same results lies beside the picture already.
  PictureTable numbers{};
};

/// Writes `folder`/`name`.svg and `name`_dark.svg, each with its title above the picture, and
/// `name`.csv with its numbers; each beside and renamed. Returns the names. Throws UserError
/// without gnuplot.
std::vector<std::string> draw_figure(const Figure& figure, const std::filesystem::path& folder);

/// gnuplot's `file` as it stands alone: the title above it, its colours for a dark page when asked
/// for. Throws UserError for a file of another form.
std::string titled_svg(std::string_view file, const Figure& figure, bool dark);

/// The SVG element of such a file alone, without the title, which the page shows: its ids made
/// unique, its colours made variables of the page, with title and description for screen readers.
/// Throws UserError for a file of another form.
std::string inline_svg(std::string_view file, const Figure& figure);

/// One entry of a figure's key.
struct KeyEntry {
  enum class Kind { kArea, kLine };
  std::string text;
  Colour colour;
  Kind kind = Kind::kArea;
  double width = 2;    ///< of a line
  double density = 1;  ///< of an area, 0..1
};
/// The key as one row at the top of the picture: gnuplot's own cannot span several panels. `set`
/// comes before the first panel, `unset` after it.
struct KeyRow {
  std::string set;
  std::string unset;
};
KeyRow key_row(const Figure& figure, double left_px, const std::vector<KeyEntry>& entries);

/// 1, 2 or 5 times a power of ten: the distance of about `count` tics over `range`.
double tic_distance(double range, int count);

/// gnuplot's `$name << EOD` with one line per row.
std::string data_block(std::string_view name, const std::vector<std::string>& rows);
/// `rgb '#0072b2'`
std::string rgb(const Colour& colour);

}  // namespace bess
