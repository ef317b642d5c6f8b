#include "paper/distribution_file.h"

#include "csv_fields.h"

namespace bayesian_icp::evaluate {

namespace {

template <typename Run, typename Visit>
void
forEachNumberOf(Run& run, const Visit& visit)
{
  forEachNumber(run.score, visit);
  visit(run.main_kl);
  for (int k = 0; k < 6; ++k)
    visit(run.main_coordinate_kl[k]);
  visit(run.energy_score);
  visit(run.truth_energy_score);
  visit(run.nees);
  visit(run.translation_error);
  visit(run.rotation_error);
  for (auto* vector : {&run.mean, &run.standard_deviation})
    for (int k = 0; k < 6; ++k)
      visit((*vector)[k]);
}

} // namespace

std::string
DistributionRun::header()
{
  return std::string("key,pair,method,seed,status,") + score_columns +
         ",main_kl,main_kl_x,main_kl_y,main_kl_z,main_kl_roll,main_kl_pitch,main_kl_"
         "yaw,"
         "energy_score,truth_energy_score,nees,translation_error_m,rotation_error_rad,"
         "mean_x_m,mean_y_m,mean_z_m,mean_roll_rad,mean_pitch_rad,mean_yaw_rad,"
         "sd_x_m,sd_y_m,sd_z_m,sd_roll_rad,sd_pitch_rad,sd_yaw_rad";
}

std::string
DistributionRun::row() const
{
  CsvRow row;
  row.add(name.key).add(name.pair).add(name.method).add(name.seed).add(score.status);
  forEachNumberOf(*this, [&row](double number) { row.add(number); });
  return row.text();
}

DistributionRun
DistributionRun::ofRow(const std::string& line)
{
  CsvFields fields(line);
  DistributionRun run;
  run.name.key = fields.text();
  run.name.pair = fields.text();
  run.name.method = fields.text();
  fields.read(run.name.seed);
  run.score.status = fields.text();
  forEachNumberOf(run, [&fields](double& number) { fields.read(number); });
  fields.end();
  return run;
}

} // namespace bayesian_icp::evaluate
