# Makes the chains and the reference values of diagnostics_test.cpp.
# Run in this folder: Rscript make_reference.R  (Debian 12: r-cran-posterior 1.4.0)
#
#   <case>.csv     draws, one column a chain
#   reference.csv  rhat, ess_bulk, ess_tail, mcse_mean of package posterior; NaN for
#                  NA, Inf for the R-hat of chains that never move
#   quantiles.csv  R's quantile(type = 7) over all draws of a case
#   versions.csv   what made them
#
# mcse_mean of large_offset is that of the draws without the offset, a subtraction
# without round-off: posterior rounds the chain means, which costs it ten digits there.
# one_infinite has no reference: posterior ranks an infinite draw like a number, the
# library under test reports NaN.
suppressMessages(library(posterior))
RNGkind("Mersenne-Twister", "Inversion", "Rejection")
set.seed(20210601)

# Stationary AR(1) chains with variance 1.
ar1 <- function(draws, chains, rho) {
  x <- matrix(rnorm(draws * chains), draws, chains)
  for (i in 2:draws) x[i, ] <- rho * x[i - 1, ] + sqrt(1 - rho^2) * x[i, ]
  x
}
normal <- function(draws, chains) matrix(rnorm(draws * chains), draws, chains)
with_entry <- function(x, value) { x[7, 2] <- value; x }

cases <- list(
  iid_normal = normal(500, 4),
  ar_sticky = ar1(300, 4, 0.9),
  ar_antithetic = ar1(300, 4, -0.25),
  ar_antithetic_bound = ar1(300, 4, -0.5), # the upper bound of the ESS holds
  alternating = matrix(c(-0.75, 1.25), 48, 2), # the first pair ends Geyer's sequence
  different_means = normal(200, 4) + rep(c(0, 0, 0.5, 2), each = 200),
  different_scales = normal(200, 4) * rep(c(1, 1, 2, 5), each = 200),
  cauchy = matrix(rcauchy(200 * 4), 200, 4),
  odd_draws = ar1(101, 4, 0.5),
  one_chain = ar1(300, 1, 0.3),
  one_chain_odd = ar1(51, 1, 0.3),
  two_chains = ar1(200, 2, 0.7),
  ties = matrix(rpois(120 * 4, 3), 120, 4),
  two_values = matrix(sample(c(-1, 1), 100 * 2, TRUE), 100, 2),
  rare_events = matrix(as.numeric(runif(100 * 4) < 0.03), 100, 4),
  four_draws = normal(4, 4),
  five_draws = normal(5, 4),
  six_draws = normal(6, 4),
  eleven_draws = normal(11, 2),
  trend = normal(200, 4) + 10 * (1:200) / 200,
  large_offset = ar1(200, 4, 0.5) * 1e-3 + 5e6,
  tiny_scale = normal(50, 2) * 1e-18,
  stuck_chains = matrix(rep(c(1, 2, 4, 8), each = 20), 20, 4),
  constant = matrix(0.1, 20, 4),
  one_nan = with_entry(normal(20, 4), NaN),
  one_infinite = with_entry(normal(20, 4), Inf)
)

# 17 digits carry a double exactly.
digits <- function(x) ifelse(is.na(x), "NaN", trimws(sprintf("%.17g", x)))
write_table <- function(table, file) {
  write.csv(table, file, row.names = FALSE, quote = FALSE, eol = "\n")
}

for (name in names(cases)) {
  x <- cases[[name]]
  table <- as.data.frame(matrix(digits(x), nrow(x), ncol(x)))
  write_table(setNames(table, paste0("chain", seq_len(ncol(x)))), paste0(name, ".csv"))
}

reference <- function(name) {
  x <- cases[[name]]
  offset <- if (name == "large_offset") 5e6 else 0
  values <- suppressWarnings(
    c(rhat(x), ess_bulk(x), ess_tail(x), mcse_mean(x - offset))
  )
  values[values > 1e12] <- Inf # a division by zero, up to round-off
  names(values) <- c("rhat", "ess_bulk", "ess_tail", "mcse_mean")
  data.frame(case = name, t(digits(values)))
}
names_with_reference <- setdiff(names(cases), "one_infinite")
write_table(do.call(rbind, lapply(names_with_reference, reference)), "reference.csv")

probabilities <- c(0, 0.001, 0.05, 0.25, 1 / 3, 0.5, 0.75, 0.95, 0.999, 1)
quantiles <- function(name) {
  data.frame(
    case = name, probability = digits(probabilities),
    value = digits(quantile(cases[[name]], probabilities, type = 7))
  )
}
quantile_cases <- c(
  "odd_draws", "one_chain_odd", "ties", "four_draws", "cauchy", "large_offset", "constant"
)
write_table(do.call(rbind, lapply(quantile_cases, quantiles)), "quantiles.csv")

write_table(
  data.frame(
    component = c("R", "posterior", "RNG"),
    version = c(
      as.character(getRversion()), as.character(packageVersion("posterior")),
      paste(RNGkind(), collapse = "/")
    )
  ),
  "versions.csv"
)
