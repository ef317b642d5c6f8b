/** \file
 * \brief The runs behind the experiment `accuracy`, and the CSV file that keeps them.
 */
#pragma once

#include "csv_fields.h"
#include "run_file.h"

#include <cstdint>
#include <string>
#include <tuple>

namespace bayesian_icp::evaluate {

/** \brief Errors from one start. */
struct AccuracyRun {
  struct Name {
    std::string key, pair, method;
    /** The start is a function of seed and index. */
    std::uint64_t seed = 0;
    int index = 0;

    bool
    operator<(const Name& other) const
    {
      return std::tie(key, pair, method, seed, index) <
             std::tie(other.key, other.pair, other.method, other.seed, other.index);
    }
  };

  Name name;
  /** Euclidean [m]. */
  double translation_error = 0.0;
  /** Sum of the absolute differences of roll, pitch and yaw [rad]. */
  double rotation_error = 0.0;
  std::string status;

  static std::string
  header()
  {
    return "key,pair,method,seed,start,translation_error_m,rotation_error_rad,status";
  }

  std::string
  row() const
  {
    CsvRow row;
    row.add(name.key).add(name.pair).add(name.method).add(name.seed).add(name.index);
    row.add(translation_error).add(rotation_error).add(status);
    return row.text();
  }

  static AccuracyRun
  ofRow(const std::string& line)
  {
    CsvFields fields(line);
    AccuracyRun run;
    run.name.key = fields.text();
    run.name.pair = fields.text();
    run.name.method = fields.text();
    fields.read(run.name.seed);
    fields.read(run.name.index);
    fields.read(run.translation_error);
    fields.read(run.rotation_error);
    run.status = fields.text();
    fields.end();
    return run;
  }
};

using AccuracyFile = RunFile<AccuracyRun>;

} // namespace bayesian_icp::evaluate
