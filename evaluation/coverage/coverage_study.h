/** \file
 * \brief The runs of a coverage study: the CSV file that keeps them, and those that are
 * not there yet, on all cores.
 */
#pragma once

#include "coverage/coverage_methods.h"
#include "coverage/coverage_score.h"
#include "study/run_file.h"

#include <functional>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Which run. */
struct CoverageRunName {
  std::string scene;
  std::string condition;
  std::uint64_t seed = 0;
  std::string method;
};

struct CoverageRun {
  static constexpr int num_name_columns = 4;

  CoverageRunName name;
  CoverageScore score;
  /** Those of the case. */
  std::string inputs = {};

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("scene", name.scene);
    column("condition", name.condition);
    column("seed", name.seed);
    column("method", name.method);
    column("valid", score.is_valid);
    column("nees", score.nees);
    column("region", score.region);
    column("log_score", score.log_score);
    column("energy_score", score.energy_score);
    coordinateColumns("pit_", score.pit, column, twist_names);
    coordinateColumns("z_", score.z, column, twist_names);
    coordinateColumns("relative_sd_", score.relative_sd, column, twist_names);
    column("translation_error_m", score.translation_error);
    column("rotation_error_rad", score.rotation_error);
    column("displacement_m", score.displacement);
    column("lost_displacement_m", score.lost_displacement);
    column("seconds", score.seconds);
    column("queries", score.num_queries);
    column("notes", score.notes);
    column("inputs", inputs);
  }
};

/** \brief The CSV file. */
using CoverageFile = RunFile<CoverageRun>;

/** \brief Which case. */
struct CoverageCaseName {
  std::string scene;
  std::string condition;
  std::uint64_t seed;
  /** A hash of what the case is made of, where its name does not say that; a row of
   * others does not count. */
  std::string inputs = {};
};

/** \brief Makes a case; called by several threads at once. */
using CoverageCaseMaker = std::function<CoverageCase(const CoverageCaseName&)>;

/** \brief What is run. */
struct CoverageStudy {
  std::vector<CoverageCaseName> cases;
  std::vector<CoverageMethod> methods;
  CoverageCaseMaker make_case;
  int num_threads = 1;
};

/** \brief Run every method on every case, except what \p results has; a row takes the
 * place of one of other inputs. A row does not depend on the number of threads.
 * \throws io::FileError, and what make_case throws; rows of other cases are kept */
void
runCoverageStudy(const CoverageStudy& study, CoverageFile& results);

/** \brief The rows of the study, in its order. */
std::vector<CoverageRun>
runsOf(const CoverageStudy& study, const CoverageFile& results);

/** \brief Squared Mahalanobis distances of the truth (NEES) beyond which a Gaussian has
 * 1 % and 0.01 %. A pair of a recording is good if it is below the first and not lost,
 * and bad if it is lost or above the second. */
constexpr double max_good_nees = 16.812;
constexpr double min_bad_nees = 27.856;

/** \brief A table of means, and of medians of errors, time and queries: a line a method
 * for each scene and condition, and for several together. Lost pairs have no NEES.
 * Alarms are doubts of a method about good pairs, misses are bad ones without. Poses
 * alone are neither. */
std::string
summaryOf(const std::vector<CoverageRun>& runs);

} // namespace bayesian_icp::evaluate
