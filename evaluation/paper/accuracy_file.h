/** \file
 * \brief The runs behind the experiment `accuracy`, and the CSV file that keeps them.
 */
#pragma once

#include "study/run_file.h"

#include <cstdint>
#include <string>

namespace bayesian_icp::evaluate {

/** \brief Errors from one start. */
struct AccuracyRun {
  struct Name {
    std::string key, pair, method;
    /** The start is a function of seed and index. */
    std::uint64_t seed = 0;
    int index = 0;

    template <typename Self, typename Column>
    static void
    columns(Self& self, const Column& column)
    {
      column("key", self.key);
      column("pair", self.pair);
      column("method", self.method);
      column("seed", self.seed);
      column("start", self.index);
    }
  };

  Name name;
  /** Euclidean [m]. */
  double translation_error = 0.0;
  /** Sum of the absolute differences of roll, pitch and yaw [rad]. */
  double rotation_error = 0.0;
  std::string status;

  template <typename Self, typename Column>
  static void
  columns(Self& self, const Column& column)
  {
    Name::columns(self.name, column);
    column("translation_error_m", self.translation_error);
    column("rotation_error_rad", self.rotation_error);
    column("status", self.status);
  }
};

using AccuracyFile = RunFile<AccuracyRun>;

} // namespace bayesian_icp::evaluate
