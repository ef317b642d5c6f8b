/** \file
 * \brief KL to the baseline as a function of which draws of a run are taken: the
 * paper's curves over the number of draws and over the length of burn-in.
 */
#pragma once

#include "paper/paper_baseline.h"
#include "study/run_file.h"

#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Draws of every chain: from row \p first on, \p count of them, both as totals
 * over all chains. */
struct DrawPart {
  int first = 0;
  int count = 0;
};

/** \brief What is drawn from, once per seed. */
struct CurveVariant {
  /** In the file. */
  std::string name;
  std::string method;
  /** See DrawPlan. */
  double initial_spread = 0.0;
};

/** \brief A curve: the values on its axis, and the part of a run that each means. */
struct CurvePlan {
  /** Of the file. */
  std::string name;
  std::vector<CurveVariant> variants;
  std::vector<int> values;
  DrawPart (*part)(int value);
  /** Draws of a run. */
  int num_draws = 6000;
};

/** \brief Rows of the chains that did not diverge; what they do not have is left out.
 */
PoseMatrix
partOf(const ChainSet& chains, const DrawPart& part);

/** \brief KL(baseline || draws) [nats]: x, y, z, roll, pitch, yaw, and in 6-D; infinite
 * with fewer than 10 draws. */
using CurveDivergences = Eigen::Matrix<double, 7, 1>;
CurveDivergences
curveDivergences(const PoseMatrix& draws, const PaperBaseline& baseline);

/** \brief One run at one value of the axis. */
struct CurvePoint {
  struct Name {
    std::string key;
    std::string pair;
    std::string variant;
    std::uint64_t seed = 0;
    int value = 0;

    template <typename Self, typename Column>
    static void
    columns(Self& self, const Column& column)
    {
      column("key", self.key);
      column("pair", self.pair);
      column("variant", self.variant);
      column("seed", self.seed);
      column("value", self.value);
    }
  };

  Name name;
  CurveDivergences divergences = CurveDivergences::Zero();

  template <typename Self, typename Column>
  static void
  columns(Self& self, const Column& column)
  {
    Name::columns(self.name, column);
    coordinateColumns("kl_", self.divergences, column);
    column("kl", self.divergences[6]);
  }
};

using CurveFile = RunFile<CurvePoint>;

/** \brief A pair's points of all variants, with its key. */
struct PairCurves {
  std::string key;
  std::vector<CurvePoint> points;
};

/** \brief Take from the files what is there and make the rest. */
PairCurves
studyCurves(const PaperStudy& study,
            const CurvePlan& plan,
            const ScanPair& pair,
            CurveFile& file);

} // namespace bayesian_icp::evaluate
