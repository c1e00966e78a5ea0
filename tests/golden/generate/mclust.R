# Golden values for tests/mixture: R's mclust (Scrucca, Fop, Murphy & Raftery 2016), models VVV and VVI on R's data sets
# `faithful` and `iris`. mclust's BIC has the opposite sign of ours; the file holds them as mclust gives them.
# `classification` is the one of its hierarchical start (hc, model VVV) that its EM begins from.
#
# Run (Debian: r-base-core r-cran-mclust r-cran-jsonlite):  Rscript tests/golden/generate/mclust.R > tests/golden/data/mclust.json
suppressMessages(library(mclust))
suppressMessages(library(jsonlite))

fit <- function(data, name, model, G) {
  tree <- hc(data, modelName = "VVV", use = "VARS")
  # A few thousand iterations, so that the comparison is one of maxima and not of stopping rules.
  control <- emControl(tol = c(1e-13, sqrt(.Machine$double.eps)), itmax = c(20000, 20000))
  result <- Mclust(data, G = G, modelNames = model, initialization = list(hcPairs = tree), control = control,
                   verbose = FALSE)
  parameters <- result$parameters
  list(data = name, model = model, components = G, log_likelihood = result$loglik, bic = result$bic,
       parameters = nMclustParams(model, ncol(data), G),
       classification = as.integer(hclass(tree, G)) - 1L, weights = parameters$pro, means = t(parameters$mean),
       covariances = lapply(seq_len(G), function(k) parameters$variance$sigma[, , k]))
}

data_sets <- list(faithful = as.matrix(faithful), iris = as.matrix(iris[, 1:4]))
fits <- list()
for (name in names(data_sets))
  for (model in c("VVV", "VVI"))
    for (G in 2:3) fits[[length(fits) + 1]] <- fit(data_sets[[name]], name, model, G)
cat(toJSON(list(versions = list(R = as.character(getRversion()), mclust = as.character(packageVersion("mclust"))),
                data = lapply(data_sets, unname), fits = fits), digits = NA, auto_unbox = TRUE))
