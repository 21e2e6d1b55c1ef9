#include "workstation/report/figures/figure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

#include "shared/host/file.h"
#include "shared/host/gnuplot.h"
#include "shared/host/user_error.h"

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

constexpr const char* kTitleId = "title-above";
constexpr int kTitleHeightPx = 40;

/// gnuplot writes a colour as `rgb( 31,  41,  51)`, `#ffffff` or `black`; null when it is not of the
/// palette.
const Colour* palette_colour(const std::string& colour) {
  std::string hex = colour == "black" ? std::string(kInk.light) : colour;
  if (colour.starts_with("rgb(")) {
    hex = "#";
    std::istringstream channels(colour.substr(4));
    unsigned channel = 0;
    char behind = 0;
    while (channels >> channel >> behind) hex += fmt::format("{:02x}", channel);
  }
  const auto found = std::ranges::find(kPalette, hex, &Colour::light);
  return found == kPalette.end() ? nullptr : &*found;
}

/// Replaces every colour of the palette by what `written` makes of it.
template <typename Written>
void replace_colours(const pugi::xml_node& svg, Written written) {
  for (const pugi::xpath_node& found : svg.select_nodes(".//@fill|.//@stroke|.//@color")) {
    const Colour* colour = palette_colour(found.attribute().value());
    if (colour != nullptr) found.attribute() = written(*colour).c_str();
  }
}

std::string view_box(const Figure& figure, int above_px) {
  return fmt::format("0 {} {} {}", -above_px, figure.width_px, figure.height_px + above_px);
}

/// A strip above the picture, with the title in it.
void add_title(pugi::xml_node svg, const Figure& figure) {
  svg.attribute("viewBox") = view_box(figure, kTitleHeightPx).c_str();
  svg.attribute("height") = figure.height_px + kTitleHeightPx;
  pugi::xml_node group = svg.insert_child_after("g", svg.child("desc"));
  group.append_attribute("id") = kTitleId;
  pugi::xml_node strip = group.append_child("rect");
  strip.append_attribute("y") = -kTitleHeightPx;
  strip.append_attribute("width") = figure.width_px;
  strip.append_attribute("height") = kTitleHeightPx + 1;  // no seam
  strip.append_attribute("fill") = std::string(kPaper.light).c_str();
  pugi::xml_node text = group.append_child("text");
  text.append_attribute("x") = 16;
  text.append_attribute("y") = -12;
  text.append_attribute("font-family") = "Helvetica";
  text.append_attribute("font-size") = 18;
  text.append_attribute("font-weight") = "bold";
  text.append_attribute("fill") = std::string(kInk.light).c_str();
  text.text() = figure.title.c_str();
}

pugi::xml_node svg_of(pugi::xml_document& document, std::string_view file, const Figure& figure) {
  const bool parsed = document.load_buffer(file.data(), file.size());
  const pugi::xml_node svg = document.child("svg");
  if (!parsed || !svg.child("title") || !svg.child("desc")) {
    fail("{}.svg: gnuplot drew a picture of another form than that of version 5.4", figure.name);
  }
  return svg;
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

std::vector<std::string> draw_figure(const Figure& figure, const fs::path& folder) {
  std::vector<std::string> names{figure.name + ".svg", figure.name + "_dark.svg"};
  const fs::path light = folder / names.front();
  draw_with_gnuplot(light, [&](const fs::path& output) { return script_of(figure, output); });
  const std::string drawn = read_file(light);
  write_file(folder / names.back(), titled_svg(drawn, figure, true));
  write_file(light, titled_svg(drawn, figure, false));
  if (figure.numbers.columns.empty()) return names;
  PictureTable numbers = figure.numbers;
  numbers.name = figure.name;
  write_picture(numbers, folder);
  names.push_back(picture_file(numbers));
  return names;
}

std::string titled_svg(std::string_view file, const Figure& figure, bool dark) {
  pugi::xml_document document;
  const pugi::xml_node svg = svg_of(document, file, figure);
  svg.child("title").text() = figure.title.c_str();
  svg.child("desc").text() = figure.alt.c_str();
  add_title(svg, figure);
  if (dark) replace_colours(svg, [](const Colour& colour) { return std::string(colour.dark); });
  std::ostringstream out;
  document.save(out, "");
  return out.str();
}

std::string inline_svg(std::string_view file, const Figure& figure) {
  pugi::xml_document document;
  pugi::xml_node svg = svg_of(document, file, figure);
  if (svg.remove_child(svg.find_child_by_attribute("id", kTitleId))) {
    svg.attribute("viewBox") = view_box(figure, 0).c_str();
  }
  prefix_ids(svg, figure.name);
  replace_colours(svg, [](const Colour& colour) { return fmt::format("var(--{})", colour.name); });
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
