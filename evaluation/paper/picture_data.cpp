#include "geometry/twist.h"
#include "io/coordinates.h"
#include "io/output_folder.h"
#include "io/picture_numbers.h"
#include "paper/paper_baseline.h"
#include "samplers/score.h"
#include "study/draw_statistics.h"
#include "study/run_file.h"

#include <bayesian_icp/summary.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace bayesian_icp::evaluate {

namespace {

/** More would make large pictures. */
constexpr Eigen::Index num_drawn_points = 500;

constexpr std::size_t num_cloud_methods = 2;

/** Draws of methods, by the methods' names. */
using NamedDraws = std::vector<std::pair<std::string, PoseMatrix>>;

/** What can be told apart in a picture. */
constexpr int num_digits = 7;

/** ",x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad", each with a prefix. */
std::string
coordinateColumns(const std::string& prefix)
{
  std::string columns;
  for (std::size_t k = 0; k < 6; ++k)
    columns += ',' + prefix + app::coordinateKey(k);
  return columns;
}

/** A row each of \p rows, after a name. */
template <typename Rows>
void
writeRows(const std::string& name, const Rows& rows, std::ostream& stream)
{
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    CsvRow row;
    row.add(name);
    for (Eigen::Index k = 0; k < rows.cols(); ++k)
      row.add(io::textOf(rows(i, k), num_digits));
    stream << row.text() << '\n';
  }
}

/** Points evenly spread over the cloud, one per row. */
Eigen::MatrixX3d
someOf(const Eigen::Matrix3Xd& cloud)
{
  return cloud(Eigen::all, io::evenlySpaced(cloud.cols(), num_drawn_points))
      .transpose();
}

void
writeDraws(const PaperBaseline& baseline,
           const NamedDraws& methods,
           std::ostream& stream)
{
  stream << "method" << coordinateColumns("") << '\n';
  writeRows("baseline", unwrapAbout(baseline.mean, baseline.ends), stream);
  for (const auto& [name, draws] : methods)
    writeRows(name, unwrapAbout(baseline.mean, draws), stream);
}

void
writePoints(const ScanPair& pair, const NamedDraws& methods, std::ostream& stream)
{
  stream << "cloud,x_m,y_m,z_m\n";
  writeRows("target", someOf(pair.target), stream);
  writeRows("before", someOf(pair.source), stream);
  for (std::size_t i = 0; i < std::min(methods.size(), num_cloud_methods); ++i)
    writeRows(methods[i].first,
              someOf(isometryOf(meanPose(methods[i].second)) * pair.source),
              stream);
  writeRows("truth", someOf(pair.truth * pair.source), stream);
}

std::string
baselineRow(const ComparedPair& compared)
{
  const ScanPair& pair = compared.problem.pair;
  const PaperBaseline& baseline = compared.baseline;
  const Moments moments = momentsOf(unwrapAbout(baseline.mean, baseline.ends));
  CsvRow row;
  row.add(pair.name).add(pair.source.cols()).add(pair.target.cols());
  row.add(baseline.ends.rows()).add(baseline.mainShare());
  for (int k = 0; k < 6; ++k)
    row.add(std::sqrt(moments.covariance(k, k)));
  return row.text();
}

/** A run of each method that is shown. */
NamedDraws
shownDraws(const PaperProblem& problem, const PaperStudyOptions& options)
{
  DrawPlan plan;
  plan.seed = options.seed;
  plan.num_threads = options.num_threads;
  NamedDraws shown;
  for (const char* name : {"bayesian-icp", "calibrated", "exact", "online-icp"}) {
    const PoseMatrix draws =
        pooledDraws(paperMethod(name).run(problem, plan).chains.chains);
    if (draws.rows() >= min_scored_draws)
      shown.emplace_back(name, draws);
  }
  return shown;
}

} // namespace

void
writeBaselines(const std::string& folder, const std::vector<ComparedPair>& pairs)
{
  io::OutputFolder files(folder);
  files.add("baseline.csv", [&pairs](std::ostream& stream) {
    stream << "pair,source_points,target_points,runs,main_basin_share"
           << coordinateColumns("sd_") << '\n';
    for (const ComparedPair& pair : pairs)
      stream << baselineRow(pair) << '\n';
  });
  files.commit();
}

void
writePictureData(const ComparedPair& compared, const PaperStudyOptions& options)
{
  const ScanPair& pair = compared.problem.pair;
  const NamedDraws methods = shownDraws(compared.problem, options);
  io::OutputFolder files(options.output_folder);
  files.add("draws_" + pair.name + ".csv", [&](std::ostream& stream) {
    writeDraws(compared.baseline, methods, stream);
  });
  files.add("points_" + pair.name + ".csv",
            [&](std::ostream& stream) { writePoints(pair, methods, stream); });
  files.commit();
}

} // namespace bayesian_icp::evaluate
