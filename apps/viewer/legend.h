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

/** \brief Lines of at most \p width characters, broken at blanks where there are any.
 */
std::string
wrapped(const std::string& text, std::size_t width);

} // namespace bayesian_icp::viewer
