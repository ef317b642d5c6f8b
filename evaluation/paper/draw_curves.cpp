#include "paper/draw_curves.h"

#include "samplers/score.h"
#include "study/draw_statistics.h"

#include <algorithm>
#include <limits>

namespace bayesian_icp::evaluate {

namespace {

/** A curve's runs of one pair. */
class CurveRuns {
public:
  CurveRuns(const PaperStudy& study,
            const CurvePlan& plan,
            const PaperProblem& problem,
            CurveFile& file)
  : options_(study.options)
  , plan_(plan)
  , problem_(problem)
  , file_(file)
  , baseline_(keptBaseline(study, problem))
  , key_(baselineKey(study.options, problem))
  {}

  /** Make the points of a run that are not in the file. */
  void
  complete(const CurveVariant& variant, int repeat)
  {
    DrawPlan draws;
    draws.num_draws = plan_.num_draws;
    draws.seed = seedOfRepeat(repeat);
    draws.num_threads = options_.num_threads;
    draws.initial_spread = variant.initial_spread;
    ChainSet chains;
    for (const int value : plan_.values) {
      const CurvePoint::Name name = nameOf(variant, repeat, value);
      if (file_.find(name) != nullptr)
        continue;
      if (chains.chains.empty())
        chains = paperMethod(variant.method).run(problem_, draws).sampled.chains;
      file_.add({name, curveDivergences(partOf(chains, plan_.part(value)), baseline_)});
    }
  }

  /** The points of a run, which is complete. */
  void
  addTo(std::vector<CurvePoint>& points, const CurveVariant& variant, int repeat) const
  {
    for (const int value : plan_.values)
      points.push_back(*file_.find(nameOf(variant, repeat, value)));
  }

  const std::string&
  key() const
  {
    return key_;
  }

private:
  std::uint64_t
  seedOfRepeat(int repeat) const
  {
    return options_.seed + static_cast<std::uint64_t>(repeat);
  }

  CurvePoint::Name
  nameOf(const CurveVariant& variant, int repeat, int value) const
  {
    return {key_, problem_.pair.name, variant.name, seedOfRepeat(repeat), value};
  }

  const PaperStudyOptions& options_;
  const CurvePlan& plan_;
  const PaperProblem& problem_;
  CurveFile& file_;
  PaperBaseline baseline_;
  std::string key_;
};

} // namespace

PoseMatrix
partOf(const ChainSet& chains, const DrawPart& part)
{
  const auto num_chains = static_cast<Eigen::Index>(chains.chains.size());
  const Eigen::Index first = part.first / num_chains, count = part.count / num_chains;
  PoseMatrix rows(0, 6);
  for (const Chain& chain : chains.chains) {
    const Eigen::Index num_rows =
        chain.diverged ? 0
                       : std::clamp<Eigen::Index>(chain.draws.rows() - first, 0, count);
    const Eigen::Index begin = rows.rows();
    rows.conservativeResize(begin + num_rows, 6);
    rows.bottomRows(num_rows) =
        chain.draws.middleRows(num_rows > 0 ? first : 0, num_rows);
  }
  return rows;
}

CurveDivergences
curveDivergences(const PoseMatrix& draws, const PaperBaseline& baseline)
{
  CurveDivergences divergences;
  divergences.setConstant(std::numeric_limits<double>::infinity());
  if (draws.rows() < min_scored_draws)
    return divergences;
  const Moments p = momentsOf(unwrapAbout(baseline.mean, baseline.ends));
  const Moments q = momentsOf(unwrapAbout(baseline.mean, draws));
  for (int k = 0; k < 6; ++k)
    divergences[k] = gaussianKl(p, q, k);
  divergences[6] = gaussianKl(p, q);
  return divergences;
}

PairCurves
studyCurves(const PaperStudy& study,
            const CurvePlan& plan,
            const ScanPair& pair,
            CurveFile& file)
{
  const PaperProblem problem(pair);
  CurveRuns runs(study, plan, problem, file);
  PairCurves curves{runs.key(), {}};
  for (const CurveVariant& variant : plan.variants) {
    for (int i = 0; i < study.options.num_repeats; ++i) {
      runs.complete(variant, i);
      runs.addTo(curves.points, variant, i);
    }
    study.report(pair.name + ": " + plan.name + ", " + variant.name);
  }
  return curves;
}

} // namespace bayesian_icp::evaluate
