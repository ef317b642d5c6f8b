#include "coverage/coverage_file.h"

#include "csv_fields.h"

#include <stdexcept>
#include <tuple>

namespace bayesian_icp::evaluate {

namespace {

constexpr char columns[] =
    "scene,condition,seed,method,valid,nees,region,log_score,energy_score,"
    "pit_vx,pit_vy,pit_vz,pit_wx,pit_wy,pit_wz,z_vx,z_vy,z_vz,z_wx,z_wy,z_wz,"
    "relative_sd_vx,relative_sd_vy,relative_sd_vz,"
    "relative_sd_wx,relative_sd_wy,relative_sd_wz,"
    "translation_error_m,rotation_error_rad,displacement_m,lost_displacement_m,"
    "seconds,queries,notes";

/** Numbers of a score in the order of the columns from nees to queries. */
template <typename ScoreType, typename Visit>
void
forEachNumber(ScoreType& score, const Visit& visit)
{
  visit(score.nees);
  visit(score.region);
  visit(score.log_score);
  visit(score.energy_score);
  for (auto* vector : {&score.pit, &score.z, &score.relative_sd})
    for (int k = 0; k < 6; ++k)
      visit((*vector)[k]);
  visit(score.translation_error);
  visit(score.rotation_error);
  visit(score.displacement);
  visit(score.lost_displacement);
  visit(score.seconds);
  visit(score.num_queries);
}

} // namespace

bool
CoverageRunName::operator<(const CoverageRunName& other) const
{
  return std::tie(scene, condition, seed, method) <
         std::tie(other.scene, other.condition, other.seed, other.method);
}

std::string
CoverageRun::header()
{
  return columns;
}

std::string
CoverageRun::row() const
{
  CsvRow row;
  row.add(name.scene).add(name.condition).add(name.seed).add(name.method);
  row.add(score.is_valid ? 1 : 0);
  forEachNumber(score, [&row](auto number) { row.add(number); });
  return row.add(score.notes).text();
}

CoverageRun
CoverageRun::ofRow(const std::string& line)
{
  CsvFields fields(line);
  CoverageRun run;
  run.name.scene = fields.text();
  run.name.condition = fields.text();
  fields.read(run.name.seed);
  run.name.method = fields.text();
  const std::string is_valid = fields.text();
  if (is_valid != "0" && is_valid != "1")
    throw std::runtime_error("neither 0 nor 1");
  run.score.is_valid = is_valid == "1";
  forEachNumber(run.score, [&fields](auto& number) { fields.read(number); });
  run.score.notes = fields.text();
  fields.end();
  return run;
}

} // namespace bayesian_icp::evaluate
