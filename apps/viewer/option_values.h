/** \file
 * \brief Values of the viewer's options from text. All throw io::UsageError that names
 * the option if the text is not such a value.
 */
#pragma once

#include "viewer/view_options.h"

#include <string>

namespace bayesian_icp::viewer {

/** \brief "r,g,b" in 0 ... 1, or in 0 ... 255 if one of them is above 1. */
Color
readColor(const std::string& option, const std::string& text);

/** \brief 1 ... 64 pixels. */
int
readPointSize(const std::string& option, const std::string& text);

/** \brief 0 ... 1. */
double
readOpacity(const std::string& option, const std::string& text);

double
readNonNegative(const std::string& option, const std::string& text);

/** \brief "0" or "1". */
bool
readSwitch(const std::string& option, const std::string& text);

/** \brief Names of layers separated by commas, or "all". */
Layers
readLayers(const std::string& text);

/** \brief 1 ... 1000. */
int
readNumDraws(const std::string& option, const std::string& text);

/** \brief A positive number, or "auto", which is 0. */
double
readMagnification(const std::string& text);

/** \brief "centroid" or "origin". */
Reference
readReference(const std::string& text);

/** \brief "WIDTHxHEIGHT" in pixels, each 64 ... 8192. */
void
readSize(const std::string& text, int& width, int& height);

} // namespace bayesian_icp::viewer
