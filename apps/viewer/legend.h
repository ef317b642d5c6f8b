/** \file
 * \brief What the picture shows, in words with units.
 */
#pragma once

#include "viewer/scene.h"

#include <string>
#include <vector>

namespace bayesian_icp::viewer {

/** \brief Colour of a cloud or a shape: the user's (-fc) or ours. */
Color
colorOf(Layer layer, const ViewOptions& options);

/** \brief White on dark, black on bright. */
Color
textColorOn(const Color& background);

struct LegendLine {
  std::string text;
  Color color;
};

/** \brief One line a layer of \p panel, the title before and the magnification after
 * it.
 * \param[in] panel without layers that need draws if there are none
 * \param[in] shows_keys whether to name the key that switches the layer */
std::vector<LegendLine>
legendOf(const Panel& panel,
         const Scene& scene,
         const ViewOptions& options,
         bool shows_keys);

/** \brief The status, after the scene's note if it has one. */
std::vector<LegendLine>
statusOf(const Scene& scene, const ViewOptions& options);

/** \brief The same in lines of at most \p width characters; those that go on are
 * indented. */
std::vector<LegendLine>
wrapped(const std::vector<LegendLine>& lines, std::size_t width);

/** \brief Three lengths [m] in one unit with three digits: "1.2, 0.8, 0.04 mm". */
std::string
textOfLengths(const Eigen::Vector3d& lengths);

/** \brief Three angles [rad] in degrees with three digits: "20, 0.1, 0.09 deg". */
std::string
textOfAngles(const Eigen::Vector3d& angles);

} // namespace bayesian_icp::viewer
