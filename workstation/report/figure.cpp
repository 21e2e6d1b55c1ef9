#include "workstation/report/figure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <pugixml.hpp>
#include <sstream>

#include "shared/host/user_error.h"
#include "workstation/base/gnuplot.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Common look: thin axes, light grid, no box, all text in ink.
std::string style() {
  return fmt::format(
      "set encoding utf8\nset minussign\n"
      "set border 3 lw 1 lc {0}\nset tics nomirror out scale 0.5 textcolor {0}\n"
      "set title textcolor {0}\nset xlabel textcolor {0}\nset ylabel textcolor {0}\n"
      "unset key\nset grid lt 1 lw 1 lc {1}\nset format '%g'\n"
      "set style fill solid noborder\n",
      rgb(kInk), rgb(kGridLine));
}

std::string script_of(const Figure& figure, const fs::path& output) {
  return fmt::format(
             "set terminal svg size {},{} noenhanced font 'Helvetica,15' background '{}' "
             "name '{}'\nset output {}\n",
             figure.width_px, figure.height_px, kPaper.light, figure.name,
             gnuplot_quoted(output.string())) +
         style() + figure.commands;
}

/// gnuplot writes a colour as `rgb( 31,  41,  51)`, `#ffffff` or `black`.
std::string variable_of(const std::string& colour) {
  std::string hex = colour == "black" ? std::string(kInk.light) : colour;
  unsigned r = 0, g = 0, b = 0;
  if (std::sscanf(colour.c_str(), "rgb(%u,%u,%u)", &r, &g, &b) == 3) {
    hex = fmt::format("#{:02x}{:02x}{:02x}", r, g, b);
  }
  const auto found = std::ranges::find(kPalette, hex, &Colour::light);
  return found == kPalette.end() ? colour : fmt::format("var(--{})", found->name);
}

void make_colours_variable(const pugi::xml_node& svg) {
  for (const pugi::xpath_node& found : svg.select_nodes(".//@fill|.//@stroke|.//@color")) {
    found.attribute() = variable_of(found.attribute().value()).c_str();
  }
}

/// Several figures share a page, but an id may occur there only once.
void prefix_ids(const pugi::xml_node& svg, std::string_view prefix) {
  for (const pugi::xpath_node& found : svg.select_nodes(".//@id")) {
    found.attribute() = fmt::format("{}-{}", prefix, found.attribute().value()).c_str();
  }
  for (const pugi::xpath_node& found : svg.select_nodes(".//@xlink:href[starts-with(., '#')]")) {
    pugi::xml_attribute reference = found.attribute();
    reference = fmt::format("#{}-{}", prefix, reference.value() + 1).c_str();
    reference.set_name("href");
  }
}

/// gnuplot opens a group for every change of pen, used or not.
void drop_empty_groups(const pugi::xml_node& svg) {
  for (const pugi::xpath_node& group : svg.select_nodes(".//g[not(*)]")) {
    group.parent().remove_child(group.node());
  }
}

/// As wide as the page, and with words for those who cannot see it.
void describe(pugi::xml_node svg, const Figure& figure) {
  for (const char* attribute : {"width", "height", "xmlns:xlink"}) svg.remove_attribute(attribute);
  svg.append_attribute("role") = "img";
  svg.append_attribute("aria-labelledby") = fmt::format("{0}-title {0}-alt", figure.name).c_str();
  pugi::xml_node title = svg.child("title");
  title.append_attribute("id") = fmt::format("{}-title", figure.name).c_str();
  title.text() = figure.title.c_str();
  pugi::xml_node description = svg.child("desc");
  description.append_attribute("id") = fmt::format("{}-alt", figure.name).c_str();
  description.text() = figure.alt.c_str();
}

}  // namespace

void draw_figure(const Figure& figure, const fs::path& folder) {
  draw_with_gnuplot(folder / (figure.name + ".svg"),
                    [&](const fs::path& output) { return script_of(figure, output); });
}

std::string inline_svg(std::string_view file, const Figure& figure) {
  pugi::xml_document document;
  const bool parsed = document.load_buffer(file.data(), file.size());
  const pugi::xml_node svg = document.child("svg");
  if (!parsed || !svg.child("title") || !svg.child("desc")) {
    fail("{}.svg: gnuplot drew a picture of another form than that of version 5.4", figure.name);
  }
  prefix_ids(svg, figure.name);
  make_colours_variable(svg);
  drop_empty_groups(svg);
  describe(svg, figure);
  std::ostringstream out;
  svg.print(out, "");
  return out.str();
}

KeyRow key_row(const Figure& figure, double left_px, const std::vector<KeyEntry>& entries) {
  constexpr double kSwatchPx = 24, kGapPx = 8, kCharacterPx = 8.1, kBetweenPx = 26;
  constexpr double kHalfHeightPx = 6, kFromTopPx = 17;
  constexpr int kFirstTag = 100;
  KeyRow row;
  double x_px = left_px;
  int tag = kFirstTag;
  const double y = 1 - kFromTopPx / figure.height_px;
  const double half_height = kHalfHeightPx / figure.height_px;
  for (const KeyEntry& entry : entries) {
    const double left = x_px / figure.width_px, right = (x_px + kSwatchPx) / figure.width_px;
    if (entry.kind == KeyEntry::Kind::kArea) {
      row.set += fmt::format(
          "set object {} rectangle from screen {},{} to screen {},{} fc {} fs transparent solid {} "
          "noborder front\n",
          tag, left, y - half_height, right, y + half_height, rgb(entry.colour), entry.density);
      row.unset += fmt::format("unset object {}\n", tag);
    } else {
      row.set +=
          fmt::format("set arrow {} from screen {},{} to screen {},{} nohead front lw {} lc {}\n",
                      tag, left, y, right, y, entry.width, rgb(entry.colour));
      row.unset += fmt::format("unset arrow {}\n", tag);
    }
    row.set += fmt::format("set label {} {} at screen {},{} left front textcolor {}\n", tag,
                           gnuplot_quoted(entry.text),
                           (x_px + kSwatchPx + kGapPx) / figure.width_px, y, rgb(kInk));
    row.unset += fmt::format("unset label {}\n", tag);
    x_px += kSwatchPx + kGapPx + kCharacterPx * static_cast<double>(entry.text.size()) + kBetweenPx;
    ++tag;
  }
  return row;
}

double tic_distance(double range, int count) {
  const double rough = std::max(range, 1e-9) / count;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (rough <= factor * power) return factor * power;
  }
  return 10 * power;
}

std::string data_block(std::string_view name, const std::vector<std::string>& rows) {
  std::string text = fmt::format("${} << EOD\n", name);
  for (const std::string& row : rows) text += row + "\n";
  return text + "EOD\n";
}

std::string rgb(const Colour& colour) { return fmt::format("rgb '{}'", colour.light); }

}  // namespace bess
