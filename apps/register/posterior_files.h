/** \file
 * \brief What a run leaves behind: samples.csv has its draws, posterior.json all else.
 */
#pragma once

#include "io/output_folder.h"
#include "register/run.h"

#include <nlohmann/json_fwd.hpp>

#include <iosfwd>
#include <optional>
#include <string>

namespace bayesian_icp::app {

/** \brief Where the final transformation is in the posterior. */
struct FinalPlace {
  /** Whether its squared Mahalanobis distance from the posterior mean is below the
   * 99.99 % quantile of chi-square with 6 degrees of freedom. */
  bool is_within_posterior = false;
  /** Root mean square distance of the source's points that it moves from where the
   * posterior mean moves them [m]. */
  double distance_from_mean = 0.0;
};

/** \brief Compare the final transformation of \p run with its posterior.
 * \return nothing unless the status is Ok or Doubtful */
std::optional<FinalPlace>
finalPlace(const Run& run);

/** \brief The document as text. Lengths are in metres, angles in radians; numbers that
 * are not finite are null. */
std::string
posteriorJson(const Run& run);

/** \brief Parts of the document: a cloud, ICP's result, a mean pose, the final
 * transformation, a covariance with its convention in words, times. */
nlohmann::ordered_json
cloudJson(const io::CloudFile& cloud);
nlohmann::ordered_json
icpJson(const RegistrationResult& result);
nlohmann::ordered_json
meanJson(const Vector6d& mean);
nlohmann::ordered_json
finalTransformationJson(const Run& run);
nlohmann::ordered_json
covarianceJson(CovarianceConvention convention, const Matrix6d& matrix);
nlohmann::ordered_json
timeJson(const Run& run);

/** \brief The draws of the chains that have not diverged: a header with units, then a
 * line a draw with 17 significant digits, chains and draws counted from 0. */
void
writeSamples(const std::vector<Chain>& chains, std::ostream& stream);

/** \brief Put samples.csv and posterior.json on their way into \p folder.
 * \throws io::FileError if one cannot be written */
void
addPosteriorFiles(const Run& run, io::OutputFolder& folder);

} // namespace bayesian_icp::app
