#include "workstation/report/figures/figure.h"

#include <gtest/gtest.h>

#include "shared/host/user_error.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

Figure figure_named(const std::string& name) {
  Figure figure;
  figure.name = name;
  figure.title = "A < B";
  figure.alt = "two points";
  return figure;
}

constexpr const char* kSvg =
    "<?xml version=\"1.0\"?>\n<svg viewBox='0 0 100 50' "
    "height='50'><title>x</title>\n<desc>Produced by</desc>\n"
    "<g fill=\"none\" color=\"black\">\n</g>\n"
    "<circle id='gpDot' fill='rgb( 31,  41,  51)'/><use xlink:href='#gpDot'/>\n</svg>\n";

TEST(Figure, InlinedSvgStandsBesideOthers) {
  const std::string svg = inline_svg(kSvg, figure_named("prices"));
  EXPECT_NE(svg.find("id=\"prices-gpDot\" fill=\"var(--ink)\""), std::string::npos) << svg;
  EXPECT_NE(svg.find(" href=\"#prices-gpDot\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("A &lt; B</title>"), std::string::npos) << svg;
  EXPECT_EQ(svg.find("<?xml"), std::string::npos);
  EXPECT_EQ(svg.find("<g "), std::string::npos) << "an empty group is left";
}

TEST(Figure, OnlyColoursOfThePaletteBecomeVariables) {
  const std::string svg = inline_svg(
      "<svg><title/><desc/><path stroke='black' fill='#ffffff' color='rgb(1,2,3)'/>"
      "<text> black</text></svg>",
      figure_named("prices"));
  EXPECT_NE(svg.find("stroke=\"var(--ink)\" fill=\"var(--paper)\" color=\"rgb(1,2,3)\""),
            std::string::npos)
      << svg;
  EXPECT_NE(svg.find("<text> black</text>"), std::string::npos) << svg;
}

TEST(Figure, StandsAloneWithItsTitleLightAndDark) {
  Figure figure = figure_named("prices");
  figure.width_px = 100;
  figure.height_px = 50;
  const std::string light = titled_svg(kSvg, figure, false);
  EXPECT_NE(light.find("viewBox=\"0 -40 100 90\" height=\"90\""), std::string::npos) << light;
  EXPECT_NE(light.find("fill=\"#1f2933\">A &lt; B</text>"), std::string::npos) << light;
  EXPECT_NE(light.find("rgb( 31,  41,  51)"), std::string::npos) << light;
  const std::string dark = titled_svg(kSvg, figure, true);
  EXPECT_NE(dark.find("id=\"gpDot\" fill=\"#e4e8eb\""), std::string::npos) << dark;
  EXPECT_EQ(dark.find("#1f2933"), std::string::npos) << dark;
  const std::string inlined = inline_svg(light, figure);
  EXPECT_EQ(inlined.find("</text>"), std::string::npos) << inlined;
  EXPECT_NE(inlined.find("viewBox=\"0 0 100 50\""), std::string::npos) << inlined;
}

TEST(Figure, APictureOfAnotherFormIsRefused) {
  for (const char* svg : {"", "<svg><title/><desc/>", "<svg><title/></svg>", "<html/>"}) {
    EXPECT_THROW((void)inline_svg(svg, figure_named("prices")), UserError) << svg;
  }
}

TEST(Figure, TicDistancesAreRound) {
  EXPECT_DOUBLE_EQ(tic_distance(0.83, 3), 0.5);
  EXPECT_DOUBLE_EQ(tic_distance(140, 6), 50);
  EXPECT_DOUBLE_EQ(tic_distance(1000, 10), 100);
  EXPECT_GT(tic_distance(0, 3), 0);
}

TEST(Html, TextIsEscaped) {
  EXPECT_EQ(html_escaped("<a href=\"x\">Tom & 'J'"),
            "&lt;a href=&quot;x&quot;&gt;Tom &amp; &#39;J&#39;");
}

}  // namespace
}  // namespace bess
