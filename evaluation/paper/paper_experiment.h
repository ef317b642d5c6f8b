/** \file
 * \brief What an experiment of the paper is: a sub-command by itself, and a part of
 * `paper`. All share their options.
 */
#pragma once

#include "study/scan_pairs.h"

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace bayesian_icp::evaluate {

/** \brief Options of an experiment. Defaults are those of the standard report. */
struct PaperStudyOptions {
  /** Where the pairs are (see scan_pairs.h), and names as given; none: all there are.
   */
  std::string data_folder = "data";
  std::vector<std::string> pairs;
  /** Everything goes here, and what is there is not made again. */
  std::string output_folder = "results/paper";
  std::uint64_t seed = 1;
  int num_threads = 1;
  /** Source points that are used, chosen at random; 0: all. */
  int num_points = 0;
  /** Runs of Monte Carlo ICP a pair, and half the range of their starts [m, rad]. */
  int num_baseline_runs = 1000;
  double start_translation = 1.0;
  double start_rotation = 1.0;
  /** Runs of each method (seeds) behind a mean and its standard deviation. */
  int num_repeats = 10;
  /** Fewer of everything, to see that it works. */
  bool is_quick = false;
  /** Or CSV files and medians only. */
  bool has_report = true;

  /** \brief Those of the repeats. */
  std::vector<std::uint64_t>
  seeds() const;
};

/** \brief The pairs asked for. A missing or broken one is named, with the reason, on
 * \p log and left out.
 * \param[out] num_skipped how many those were
 * \throws io::FileError if no pair is left, or the manifest is broken */
std::vector<ScanPair>
readPairs(const PaperStudyOptions& options, std::ostream& log, int& num_skipped);

/** \brief On what an experiment is made. */
struct PaperStudy {
  /** As a shell takes it. */
  std::string command;
  PaperStudyOptions options;
  /** Those that could be read, thinned; at least one. */
  std::vector<ScanPair> pairs;
  /** Pairs that were asked for and could not be read. */
  int num_skipped = 0;
  /** Gets lines of progress. */
  std::function<void(const std::string&)> report;

  /** \brief The name of a file in the output folder, which exists. */
  std::string
  path(const std::string& file) const
  {
    return options.output_folder + "/" + file;
  }
};

/** \brief A pair, and the column `key` of its rows. */
struct PairKey {
  std::string pair;
  std::string key;
};

/** \brief Note in study.json what the last run of an experiment asked for: command,
 * seeds, pairs; and the versions of what took part. What is there of other experiments
 * stays. \param[in] name of its CSV file, without .csv \param[in] num_starts rows are
 * those of the first seed and of this number of starts; 0: of as many seeds as there
 * are repeats \throws io::FileError */
void
recordExperiment(const PaperStudy& study,
                 const std::string& name,
                 const std::vector<PairKey>& pairs,
                 int num_starts = 0);

/** \brief An experiment of the paper. */
struct NamedExperiment {
  /** Of the sub-command. */
  std::string name;
  /** What it does: one line, and more for --help. */
  std::string summary;
  std::string details;
  /** Options that it has no use for. */
  std::vector<std::string> unused;
  /** Runs what is not yet in the experiment's files in the output folder, and prints
   * medians of all of it; throws io::FileError. */
  std::function<void(const PaperStudy&)> run;
};

/** \brief All of them, in the order of the report. */
std::vector<NamedExperiment>
paperExperiments();

} // namespace bayesian_icp::evaluate
