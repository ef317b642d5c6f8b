// The report's verdict in words, its escaping, and what its charts are given.
#include "html/page.h"
#include "io/picture_numbers.h"
#include "report/charts.h"
#include "report/draw_set.h"
#include "report/path_charts.h"
#include "report/verdict.h"
#include "summary/estimates.h"

#include <gtest/gtest.h>

#include <boost/algorithm/string/replace.hpp>

#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>

namespace bayesian_icp::app {
namespace {

const double pi = std::acos(-1.0);
const double unknown = std::numeric_limits<double>::quiet_NaN();

/** With blanks in place of no-break spaces. */
std::string
plain(const std::string& text)
{
  return boost::replace_all_copy(text, "\u00A0", " ");
}

/** Four chains' posterior with 0.4 mm and 0.1 degrees. */
Summary
summaryWith(Status status)
{
  Summary summary;
  summary.status = status;
  summary.message = "so it is";
  summary.num_chains = 4;
  summary.num_draws = 2000;
  for (std::size_t k = 0; k < 6; ++k) {
    // The pose is that of the mean, not of the coordinates' own means.
    summary.mean[static_cast<Eigen::Index>(k)] = k < 3 ? 0.0213 : 0.5;
    summary.coordinates[k].mean = k < 3 ? 0.0113 : 0.4;
    summary.coordinates[k].standard_deviation = k < 3 ? 0.0004 : 0.1 * pi / 180.0;
    summary.coordinates[k].rhat = 1.1;
  }
  return summary;
}

const char* const pose_text = "x 0.02130 m ± 0.40 mm, y 0.02130 m ± 0.40 mm, "
                              "z 0.02130 m ± 0.40 mm, roll 28.65° ± 0.10°, "
                              "pitch 28.65° ± 0.10°, yaw 28.65° ± 0.10°";

DataDirection
direction(Observability observability, const std::string& description)
{
  DataDirection result;
  result.observability = observability;
  result.description = description;
  return result;
}

TEST(UncertainText, HasTwoDigitsOfTheDeviationAndTheMeanToMatch)
{
  EXPECT_EQ(plain(uncertainText(0, 1.23456789, 0.00042)), "x 1.23457 m ± 0.42 mm");
  EXPECT_EQ(plain(uncertainText(1, -12.3456, 0.37)), "y -12.35 m ± 0.37 m");
  EXPECT_EQ(plain(uncertainText(2, -1e-9, 0.02)), "z 0.000 m ± 20 mm");
  EXPECT_EQ(plain(uncertainText(5, pi / 2, 10 * pi / 180)), "yaw 90° ± 10°");
}

TEST(UncertainText, SaysWhatIsNotKnown)
{
  EXPECT_EQ(plain(uncertainText(0, 1.5, unknown)), "x 1.5000 m ± unknown");
  EXPECT_EQ(plain(uncertainText(3, unknown, unknown)), "roll unknown");
  EXPECT_EQ(plain(uncertainText(0, 1.5, 0.0)), "x 1.5000 m ± 0 mm");
}

TEST(Verdict, GoodPoseIsTold)
{
  const Verdict verdict = verdictOf(summaryWith(Status::Ok), Preset::Calibrated);
  EXPECT_EQ(verdict.tone, html::Tone::Good);
  EXPECT_EQ(plain(verdict.sentence), std::string(pose_text) + '.');
  EXPECT_EQ(verdict.scale_note, "");
}

TEST(Verdict, MotionsThatCannotBeObservedAreNamedAndTakeAwayTheGoodTone)
{
  Summary summary = summaryWith(Status::Ok);
  summary.data.is_available = true;
  summary.data.directions.assign(4, direction(Observability::Observed, "a motion"));
  EXPECT_EQ(verdictOf(summary, Preset::Calibrated).tone, html::Tone::Good);
  summary.data.directions.push_back(direction(Observability::Weak, "rotation about y"));
  EXPECT_EQ(verdictOf(summary, Preset::Calibrated).tone, html::Tone::Caution);
  EXPECT_EQ(verdictOf(summary, Preset::Calibrated).heading,
            "Reliable, but 1 of 6 motions cannot be observed well");
  summary.data.directions.push_back(
      direction(Observability::PriorOnly, "rotation about z"));
  const Verdict verdict = verdictOf(summary, Preset::Calibrated);
  EXPECT_EQ(verdict.tone, html::Tone::Caution);
  EXPECT_EQ(verdict.heading, "Reliable, but 2 of 6 motions cannot be observed well");
  EXPECT_EQ(plain(verdict.sentence),
            std::string(pose_text) +
                "; not observable in these clouds, held by the prior alone: rotation "
                "about z; hardly observable: rotation about y.");
}

TEST(Verdict, FlagsAreNamed)
{
  Summary summary = summaryWith(Status::Doubtful);
  summary.data.is_available = true;
  summary.data.flags.misfit = true;
  summary.data.flags.few_patches = true;
  const Verdict verdict = verdictOf(summary, Preset::Calibrated);
  EXPECT_EQ(verdict.tone, html::Tone::Caution);
  EXPECT_EQ(plain(verdict.sentence),
            std::string(pose_text) + "; flags: few patches, misfit.");
}

TEST(Verdict, WhatNotToTrustComesFirst)
{
  Summary summary = summaryWith(Status::NotMixed);
  Verdict verdict = verdictOf(summary, Preset::Paper);
  EXPECT_EQ(verdict.tone, html::Tone::Bad);
  EXPECT_EQ(verdict.heading, "Do not trust the ±: the chains have not mixed");
  Summary particles = summary;
  particles.coordinates[0].rhat = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(verdictOf(particles, Preset::Exact).heading,
            "Do not trust the ±: the draws have not converged");
  EXPECT_NE(verdict.scale_note.find("not estimated from the clouds"),
            std::string::npos);

  summary.status = Status::Diverged;
  summary.num_diverged_chains = 3;
  verdict = verdictOf(summary, Preset::Exact);
  EXPECT_EQ(verdict.heading, "Do not trust this posterior: 3 of 4 chains diverged");
  EXPECT_EQ(plain(verdict.sentence),
            std::string("Draws of the others: ") + pose_text + '.');

  summary.status = Status::Cancelled;
  verdict = verdictOf(summary, Preset::Calibrated);
  EXPECT_EQ(verdict.heading, "Interrupted: do not trust the ±");
  EXPECT_NE(verdict.sentence.find("until then (2000)"), std::string::npos);
}

TEST(Verdict, SeveralModesHaveAPoseEach)
{
  Summary summary = summaryWith(Status::SeveralModes);
  Mode mode;
  mode.weight = 0.7;
  mode.mean = Vector6d::Zero();
  mode.covariances.fill(1e-6 * Matrix6d::Identity());
  summary.modes = {mode, mode};
  summary.modes[1].weight = 0.001;
  summary.modes[1].mean[0] = 0.1;
  const Verdict verdict = verdictOf(summary, Preset::Exact);
  EXPECT_EQ(verdict.heading, "Do not use one mean: 2 different poses fit");
  const std::string sentence = plain(verdict.sentence);
  EXPECT_EQ(sentence.rfind("pose 1 (weight about 0.70): x 0.0000 m ± 1.0 mm", 0), 0u)
      << sentence;
  EXPECT_NE(sentence.find("; or pose 2 (weight below 0.01): x 0.1000 m ± 1.0 mm"),
            std::string::npos)
      << sentence;
}

TEST(Verdict, WithoutDrawsThereIsTheReason)
{
  Summary summary;
  summary.status = Status::InvalidInput;
  summary.message = "a cloud is empty";
  const Verdict verdict = verdictOf(summary, Preset::Paper);
  EXPECT_EQ(verdict.heading, "There is no posterior");
  EXPECT_EQ(verdict.sentence, "a cloud is empty.");
}

TEST(Escape, LeavesNoMarkup)
{
  EXPECT_EQ(html::escaped("<b a=\"1\" c='2'>&amp;"),
            "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;amp;");
  EXPECT_EQ(html::escaped("tab\tline\n"), "tab\tline\n");
}

TEST(Escape, KeepsUtf8AndReplacesAllElse)
{
  EXPECT_EQ(html::escaped("± \u20AC \U0001F600"), "± \u20AC \U0001F600");
  const std::string bad = "\uFFFD";
  EXPECT_EQ(html::escaped("a\xFFz"), "a" + bad + "z");
  EXPECT_EQ(html::escaped("\xC0\xAF"), bad + bad);           // longer than needed
  EXPECT_EQ(html::escaped("\xED\xA0\x80"), bad + bad + bad); // half of a surrogate pair
  EXPECT_EQ(html::escaped("\xF4\x90\x80\x80"), bad + bad + bad + bad); // past U+10FFFF
  EXPECT_EQ(html::escaped("\xE2\x82"), bad + bad);                     // cut short
  EXPECT_EQ(html::escaped(std::string("\0\x1B\x7F", 3)), bad + bad + bad);
}

const char* const gnuplot_svg =
    "<?xml version=\"1.0\"?>\n<svg \n width=\"9\" viewBox=\"0 0 9 9\"\n>\n"
    "<title>Gnuplot</title><desc>x</desc><g id=\"gnuplot_canvas\">"
    "<defs><circle id='gpDot'/><path id='gpPt5'/>"
    "<use xlink:href='#gpPt5' id='gpPt6'/></defs>"
    "<text fill=\"black\">1</text><path stroke='black'/>%s</g></svg>\n";

std::string
svgWith(const std::string& content)
{
  std::string svg = gnuplot_svg;
  return svg.replace(svg.find("%s"), 2, content);
}

TEST(InlineSvg, HasIdsOfItsOwnATitleAndThePagesColour)
{
  const std::string svg = html::inlineSvg(
      svgWith("<use xlink:href='#gpPt6'/>"), "figure", "Title <1>", "What & why");
  EXPECT_EQ(svg,
            "<svg id=\"figure\" viewBox=\"0 0 9 9\" role=\"img\" "
            "aria-labelledby=\"figure-title figure-description\">"
            "<title id=\"figure-title\">Title &lt;1&gt;</title>"
            "<desc id=\"figure-description\">What &amp; why</desc>\n<g>"
            "<defs><circle id='figure-gpDot'/><path id='figure-gpPt5'/>"
            "<use xlink:href='#figure-gpPt5' id='figure-gpPt6'/></defs>"
            "<text fill=\"currentColor\">1</text><path stroke='currentColor'/>"
            "<use xlink:href='#figure-gpPt6'/></g></svg>");
}

TEST(InlineSvg, LeavesOutMarkersThatNobodyUses)
{
  const std::string svg = html::inlineSvg(svgWith(""), "figure", "a", "b");
  EXPECT_EQ(svg.find("defs"), std::string::npos) << svg;
  EXPECT_NE(svg.find("<text"), std::string::npos) << svg;
}

/** Two chains of so many draws about yaw = pi; yaw takes the values one after the
 * other. */
RegistrationResult
resultWith(const std::vector<std::vector<double>>& yaws)
{
  ChainSet set;
  for (const auto& of_chain : yaws) {
    Chain chain;
    chain.draws = PoseMatrix::Zero(static_cast<Eigen::Index>(of_chain.size()), 6);
    for (std::size_t i = 0; i < of_chain.size(); ++i)
      chain.draws(static_cast<Eigen::Index>(i), 5) = wrapAngle(of_chain[i]);
    set.chains.push_back(chain);
  }
  RegistrationResult result;
  result.summary = summarize(set);
  result.chains = set.chains;
  return result;
}

TEST(DrawSet, AnglesAboutHalfATurnAreDifferencesFromTheMean)
{
  const DrawSet draws =
      drawSetOf(resultWith({{pi - 0.02, pi + 0.02}, {pi - 0.01, pi + 0.01}}));
  ASSERT_EQ(draws.chains.size(), 2u);
  const double degrees = 180.0 / pi;
  EXPECT_NEAR(draws.chains[0].errors(0, 5), -0.02 * degrees, 1e-9);
  EXPECT_NEAR(draws.chains[0].errors(1, 5), 0.02 * degrees, 1e-9);
  EXPECT_NEAR(draws.axes[5].quantile_97_5 + draws.axes[5].quantile_2_5, 0.0, 1e-9);
  EXPECT_EQ(draws.axes[5].unit, "°");
  EXPECT_EQ(draws.axes[0].unit, "mm");
}

TEST(DrawSet, ChainsWithoutDrawsAndDivergedOnesAreLeftOut)
{
  RegistrationResult result = resultWith({{0.1, 0.2}, {}, {0.3}});
  result.chains[0].diverged = true;
  const DrawSet draws = drawSetOf(result);
  ASSERT_EQ(draws.chains.size(), 1u);
  EXPECT_EQ(draws.chains[0].chain, 2);
}

TEST(DrawSet, RanksCountAllChainsAndShareTies)
{
  const DrawSet draws = drawSetOf(resultWith({{0.1, 0.4}, {0.2, 0.4, 0.0}}));
  const auto ranks = ranksOf(draws, 5);
  EXPECT_EQ(ranks[0], Eigen::Vector2d(1.0, 3.5));
  EXPECT_EQ(ranks[1], Eigen::Vector3d(2.0, 3.5, 0.0));
  // Coordinates in which nothing moves are one tie.
  EXPECT_EQ(ranksOf(draws, 0)[0], Eigen::Vector2d(2.0, 2.0));
}

TEST(DrawSet, KernelIsAsNarrowAsTheChainsAreNotAsTheirDistance)
{
  const DrawSet near = drawSetOf(resultWith({{0.0, 0.1}, {0.0, 0.1}}));
  const DrawSet far = drawSetOf(resultWith({{0.0, 0.1}, {1.0, 1.1}}));
  EXPECT_NEAR(kernelWidth(near, 5), kernelWidth(far, 5), 1e-9);
  EXPECT_GT(kernelWidth(near, 5), 0.0);
  EXPECT_EQ(kernelWidth(near, 0), 0.0);
  // Chains that do not move have a distance only.
  EXPECT_GT(kernelWidth(drawSetOf(resultWith({{0.0}, {0.1}})), 5), 1e-6);
  EXPECT_GT(kernelWidth(drawSetOf(resultWith({{0.1, 0.1, 0.1}, {0.3, 0.3, 0.3}})), 5),
            1e-6);
}

/** The numbers of a block of data of a picture's script. */
std::vector<double>
numbersOf(const std::string& block, const Chart& chart)
{
  const std::string begin = '$' + block + " << EOD\n";
  const std::size_t from = chart.drawing.script.find(begin) + begin.size();
  std::istringstream text(chart.drawing.script.substr(
      from, chart.drawing.script.find("EOD\n", from) - from));
  return {std::istream_iterator<double>(text), std::istream_iterator<double>()};
}

TEST(CloudCharts, ShowTheSourceAtTheGuessAndWhereItEnds)
{
  const auto cloudOf = [](const Eigen::Matrix3Xf& points) {
    io::CloudFile cloud;
    cloud.points = points;
    cloud.num_finite = static_cast<std::size_t>(points.cols());
    return cloud;
  };
  app::Run run;
  run.source = cloudOf(Eigen::Vector3f(1.0F, 0.0F, 0.0F).replicate(1, 3));
  run.target = cloudOf(Eigen::Matrix3f::Identity());
  run.settings.guess = matrixOf(Vector6d(0.5, 0.0, 0.0, 0.0, 0.0, 0.5 * pi));
  run.result.final_matrix = matrixOf(Vector6d(0.0, 0.0, 2.0, 0.0, 0.0, 0.0));
  const std::vector<Chart> charts = cloudCharts(run);
  ASSERT_EQ(charts.size(), 4U);
  const auto expectSource = [&](std::size_t chart, const std::array<double, 3>& point) {
    const std::vector<double> numbers = numbersOf("source", charts[chart]);
    ASSERT_EQ(numbers.size(), 9U);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(numbers[k], point[k], 1e-6) << charts[chart].id;
  };
  for (const std::size_t before : {0U, 1U})
    expectSource(before, {0.5, 1.0, 0.0});
  for (const std::size_t after : {2U, 3U})
    expectSource(after, {1.0, 0.0, 2.0});
}

TEST(PathChart, DrawsRegionsInTheFrameOfScan0)
{
  // The second pose is turned by a right angle, and surest along its own y.
  PathData path;
  path.poses.resize(2);
  path.poses[1].mean << 1.0, 2.0, 0.0, 0.0, 0.0, 0.5 * pi;
  Vector6d deviations;
  deviations << 0.1, 0.01, 0.02, 0.001, 0.002, 0.002;
  path.poses[1].covariance = deviations.array().square().matrix().asDiagonal();
  path.poses[0].covariance = 1e-8 * path.poses[1].covariance;
  const std::vector<double> ellipses = numbersOf("ellipses", pathChart(path));
  ASSERT_EQ(ellipses.size(), 10U);
  // The 95 % quantile of chi-square with two degrees of freedom is 5.991.
  const std::array<double, 4> expected = {
      1.0, 2.0, 0.2 * std::sqrt(5.991465), 0.02 * std::sqrt(5.991465)};
  for (std::size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(ellipses[k], expected[k], 1e-6); // the last pose is the first
  EXPECT_NEAR(std::abs(ellipses[4]), 90.0, 1e-6);

  const std::vector<Chart> charts = deviationCharts({0.0, 1.0}, "time [s]", path);
  ASSERT_EQ(charts.size(), 2U);
  EXPECT_NEAR(numbersOf("data", charts[0]).back(), deviations.head<3>().norm(), 1e-6);
  EXPECT_NEAR(numbersOf("data", charts[1]).back(),
              deviations.tail<3>().norm() * 180.0 / pi,
              1e-6);
}

TEST(EvenlySpaced, CoversAllAndGivesEachChainItsShare)
{
  using Indices = std::vector<Eigen::Index>;
  EXPECT_EQ(io::evenlySpaced(3, 10), (Indices{0, 1, 2}));
  EXPECT_EQ(io::evenlySpaced(10, 4), (Indices{0, 2, 5, 7}));
  EXPECT_EQ(io::evenlySpaced(10, 0), (Indices{0}));
  EXPECT_TRUE(io::evenlySpaced(0, 4).empty());
  std::array<int, 4> of_chain{};
  for (const Eigen::Index index : io::evenlySpaced(2000, 20))
    ++of_chain[static_cast<std::size_t>(index / 500)];
  EXPECT_EQ(of_chain, (std::array<int, 4>{5, 5, 5, 5}));
}

TEST(RoundedUp, IsTheNextRoundNumber)
{
  for (const auto& [value, expected] :
       {std::pair(0.0123, 0.015), {0.015, 0.015}, {0.9, 1.0}, {1.0, 1.0}, {21.0, 25.0}})
    EXPECT_DOUBLE_EQ(io::roundedUp(value), expected);
  EXPECT_GT(io::roundedUp(0.0), 0.0);
  EXPECT_GT(io::roundedUp(unknown), 0.0);
}

} // namespace
} // namespace bayesian_icp::app
