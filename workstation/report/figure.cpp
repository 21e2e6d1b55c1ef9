#include "workstation/report/figure.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shared/host/user_error.h"
#include "workstation/base/gnuplot.h"
#include "workstation/report/html.h"

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

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

std::string variable_of(std::string_view hex) {
  for (const Colour& colour : kPalette) {
    if (hex == colour.light) return fmt::format("var(--{})", colour.name);
  }
  return std::string(hex);
}

/// gnuplot writes a colour as `rgb( 31,  41,  51)`, `#ffffff` or `black`.
void make_colours_variable(std::string& svg) {
  for (std::size_t at = svg.find("rgb("); at != std::string::npos; at = svg.find("rgb(", at + 1)) {
    unsigned r = 0, g = 0, b = 0;
    if (std::sscanf(svg.c_str() + at, "rgb(%u,%u,%u)", &r, &g, &b) != 3) continue;
    const std::size_t end = svg.find(')', at) + 1;
    svg.replace(at, end - at, variable_of(fmt::format("#{:02x}{:02x}{:02x}", r, g, b)));
  }
  for (const std::string_view attribute : {"fill", "stroke", "color"}) {
    replace_all(svg, fmt::format("{}=\"black\"", attribute),
                fmt::format("{}=\"var(--{})\"", attribute, kInk.name));
    replace_all(svg, fmt::format("{}=\"{}\"", attribute, kPaper.light),
                fmt::format("{}=\"var(--{})\"", attribute, kPaper.name));
  }
}

/// Several figures share a page, but an id may occur there only once.
void prefix_ids(std::string& svg, std::string_view prefix) {
  for (const char quote : {'\'', '"'}) {
    replace_all(svg, fmt::format(" id={}", quote), fmt::format(" id={}{}-", quote, prefix));
    replace_all(svg, fmt::format("xlink:href={}#", quote),
                fmt::format("href={}#{}-", quote, prefix));
  }
}

/// gnuplot opens a group for every change of pen, used or not.
void drop_empty_groups(std::string& svg) {
  constexpr std::string_view kClose = "</g>\n";
  for (std::size_t at = svg.find("<g fill="); at != std::string::npos;
       at = svg.find("<g fill=", at)) {
    const std::size_t end = svg.find(">\n", at);
    if (end != std::string::npos && svg.compare(end + 2, kClose.size(), kClose) == 0) {
      svg.erase(at, end + 2 + kClose.size() - at);
    } else {
      ++at;
    }
  }
}

/// Between gnuplot's own head, which names the program, and its closing tag.
std::string body_of(std::string_view svg, const Figure& figure) {
  constexpr std::string_view kHeadEnd = "</desc>";
  const std::size_t head = svg.find(kHeadEnd);
  const std::size_t tail = svg.rfind("</svg>");
  if (head == std::string_view::npos || tail == std::string_view::npos) {
    fail("{}.svg: gnuplot drew a picture of another form than that of version 5.4", figure.name);
  }
  return std::string(svg.substr(head + kHeadEnd.size(), tail - head - kHeadEnd.size()));
}

}  // namespace

void draw_figure(const Figure& figure, const fs::path& folder) {
  draw_with_gnuplot(folder / (figure.name + ".svg"),
                    [&](const fs::path& output) { return script_of(figure, output); });
}

std::string inline_svg(std::string_view svg, const Figure& figure) {
  std::string body = body_of(svg, figure);
  prefix_ids(body, figure.name);
  make_colours_variable(body);
  drop_empty_groups(body);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
      "aria-labelledby=\"{2}-title {2}-alt\">\n<title id=\"{2}-title\">{3}</title>\n"
      "<desc id=\"{2}-alt\">{4}</desc>{5}</svg>\n",
      figure.width_px, figure.height_px, figure.name, html_escaped(figure.title),
      html_escaped(figure.alt), body);
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
