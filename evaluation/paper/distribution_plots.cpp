#include "paper/distribution_plots.h"

#include "draw_statistics.h"
#include "paper/kernel_density.h"

#include <bayesian_icp/calibration/twist.h>
#include <bayesian_icp/diagnostics.h>
#include <bayesian_icp/summary.h>

#include <io/numbers.h>
#include <plot/gnuplot.h>

#include <algorithm>
#include <cmath>

namespace bayesian_icp::evaluate {

namespace {

/** Points of a cloud that are drawn: more make large files. */
constexpr Eigen::Index num_drawn_points = 500;

constexpr std::size_t num_cloud_methods = 2;

std::string
labelOf(int k)
{
  return std::string(coordinate_names[static_cast<std::size_t>(k)]) +
         (k < 3 ? " [m]" : " [rad]");
}

std::string
linesOf(const DensityCurve& curve)
{
  std::string lines;
  for (Eigen::Index i = 0; i < curve.places.size(); ++i)
    lines +=
        io::textOf(curve.places[i], 5) + ' ' + io::textOf(curve.heights[i], 4) + '\n';
  return lines;
}

std::string
linesOf(const Eigen::Matrix3Xd& points)
{
  const Eigen::Index size = std::min(points.cols(), num_drawn_points);
  std::string lines;
  for (Eigen::Index i = 0; i < size; ++i) {
    const Eigen::Vector3d p = points.col(i * points.cols() / size);
    lines += io::fixedTextOf(p.x(), 4) + ' ' + io::fixedTextOf(p.y(), 4) + ' ' +
             io::fixedTextOf(p.z(), 4) + '\n';
  }
  return lines;
}

/** Same scale on all axes, and the same in all panels: those of the target. */
std::string
cloudRanges(const Eigen::Matrix3Xd& target)
{
  const Eigen::Vector3d least = target.rowwise().minCoeff();
  const Eigen::Vector3d most = target.rowwise().maxCoeff();
  const Eigen::Vector3d centre = 0.5 * (least + most);
  const double half = 0.6 * (most - least).maxCoeff();
  std::string ranges;
  for (int k = 0; k < 3; ++k)
    ranges += std::string("set ") + "xyz"[k] + "range [" +
              io::fixedTextOf(centre[k] - half, 4) + ':' +
              io::fixedTextOf(centre[k] + half, 4) + "]\n";
  return ranges;
}

} // namespace

NamedDraws
shownDraws(const PaperProblem& problem, const PaperOptions& options)
{
  DrawPlan plan;
  plan.seed = options.seed;
  plan.num_threads = options.num_threads;
  NamedDraws shown;
  for (const char* name : {"bayesian-icp", "calibrated", "exact", "online-icp"}) {
    const PaperMethod& method = paperMethod(name);
    const PoseMatrix draws =
        pooledDraws(method.run(problem, plan).sampled.chains.chains);
    if (draws.rows() >= min_scored_draws)
      shown.emplace_back(method.title, draws);
  }
  return shown;
}

void
plotDensities(const std::string& folder,
              const std::string& pair_name,
              const PaperBaseline& baseline,
              const NamedDraws& methods)
{
  NamedDraws curves = {{"Monte Carlo ICP", baseline.ends}};
  curves.insert(curves.end(), methods.begin(), methods.end());
  std::string blocks, panels = plot::panelsWithKey(2, 3);
  for (int k = 0; k < 6; ++k) {
    std::string plot;
    for (std::size_t i = 0; i < curves.size(); ++i) {
      const Eigen::VectorXd values =
          unwrapAbout(baseline.mean, curves[i].second).col(k);
      const std::string name = "density" + std::to_string(k) + std::to_string(i);
      blocks += plot::dataBlock(name, linesOf(densityOf(values)));
      plot +=
          (i > 0 ? ", $" : "plot $") + name +
          (i > 0 ? " with lines linewidth 2"
                 : " with filledcurves y1=0 linecolor '#bbbbbb'") +
          (k == 0 ? " title " + plot::quotedForGnuplot(curves[i].first) : " notitle");
    }
    panels += "set xlabel '" + labelOf(k) + "'\n" + plot + '\n';
  }
  plot::savePictures(
      "set encoding utf8\n" + blocks +
          "set yrange [0:1.05]\nunset ytics\nset xtics autofreq rotate by -30\n"
          "set ylabel 'density, largest = 1'\n" +
          plot::pictures("1200, 640", panels + "unset multiplot\n"),
      {"densities_" + pair_name},
      folder);
}

void
plotClouds(const std::string& folder, const ScanPair& pair, const NamedDraws& methods)
{
  std::vector<std::pair<std::string, Eigen::Isometry3d>> poses = {
      {"before", Eigen::Isometry3d::Identity()}};
  for (std::size_t i = 0; i < std::min(methods.size(), num_cloud_methods); ++i)
    poses.emplace_back(methods[i].first, isometryOf(meanPose(methods[i].second)));
  poses.emplace_back("truth", pair.truth);
  std::string blocks = plot::dataBlock("target", linesOf(pair.target));
  std::string panels = "set multiplot layout 1, " + std::to_string(poses.size()) + "\n";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string name = "source" + std::to_string(i);
    blocks += plot::dataBlock(name, linesOf(poses[i].second * pair.source));
    panels += "set title " + plot::quotedForGnuplot(poses[i].first) +
              "\nsplot $target with points pointtype 7 pointsize 0.15 linecolor "
              "'#0072b2' title 'target', $" +
              name +
              " with points pointtype 7 pointsize 0.15 linecolor '#d55e00' title "
              "'source'\n";
  }
  plot::savePictures(
      "set encoding utf8\n" + blocks + cloudRanges(pair.target) +
          "set view equal xyz\nset view 65, 20, 1.3\nset xyplane relative 0\n"
          "unset xtics\nunset ytics\nunset ztics\nset border 0\n"
          "set key bottom center horizontal\n" +
          plot::pictures("1200, 360", panels + "unset multiplot\n"),
      {"clouds_" + pair.name},
      folder);
}

void
plotDivergences(const std::string& folder, const Distributions& distributions)
{
  std::string ticks;
  for (std::size_t i = 0; i < distributions.size(); ++i)
    ticks += (i > 0 ? ", " : "") + plot::quotedForGnuplot(distributions[i].pair->name) +
             ' ' + std::to_string(i);
  std::string blocks, panels = plot::panelsWithKey(2, 3);
  for (int k = 0; k < 6; ++k) {
    std::string plot;
    const auto& methods = paperMethods();
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const std::string name = "kl" + std::to_string(k) + std::to_string(m);
      std::string lines;
      for (std::size_t i = 0; i < distributions.size(); ++i) {
        const Spread spread =
            spreadIn(distributions[i], methods[m].name, coordinateKl(k));
        lines += io::textOf(double(i) + 0.08 * (double(m) - 4.0)) + ' ' +
                 io::textOf(spread.num_finite > 0 ? spread.mean : std::nan("")) + '\n';
      }
      blocks += plot::dataBlock(name, lines);
      plot +=
          (m > 0 ? ", $" : "plot $") + name + " with points pointtype " +
          std::to_string(m + 4) +
          (k == 0 ? " title " + plot::quotedForGnuplot(methods[m].title) : " notitle");
    }
    panels += "set title '" +
              std::string(coordinate_names[static_cast<std::size_t>(k)]) + "'\n" +
              plot + '\n';
  }
  plot::savePictures("set encoding utf8\nset datafile missing 'nan'\n" + blocks +
                         "set logscale y\nset format y '%.0e'\nset grid y\n"
                         "set ylabel 'KL(baseline, method) [nats]'\nset xrange [-0.6:" +
                         std::to_string(distributions.size()) + " - 0.4]\nset xtics (" +
                         ticks + ") rotate by -30\n" +
                         plot::pictures("1400, 760", panels + "unset multiplot\n"),
                     {"divergences"},
                     folder);
}

} // namespace bayesian_icp::evaluate
