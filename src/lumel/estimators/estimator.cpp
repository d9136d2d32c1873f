#include "lumel/estimators/estimator.h"

#include <array>

#include "lumel/estimators/auto.h"
#include "lumel/estimators/classical.h"
#include "lumel/estimators/regression.h"
#include "lumel/estimators/weighted.h"

namespace lumel {

namespace {

constexpr std::array kEstimators{
    Estimator{"classical", "mean of f/p; unbiased", classical, classical},
    Estimator{"weighted", "ratio of the means of f/p and g/p; consistent, far less noise on gloss", weighted, weighted},
    Estimator{"regression", "f/p corrected by g/p with the best coefficient of the area's own samples; consistent", regression, regression},
    Estimator{"auto", "corrected by g/p as the neighbours of each area recommend; consistent, never far from the best", automatic,
              automatic_to_average},
};

}  // namespace

std::span<const Estimator> estimators() { return kEstimators; }

const Estimator* find_estimator(std::string_view name) {
    for (const Estimator& estimator : kEstimators)
        if (estimator.name == name) return &estimator;
    return nullptr;
}

}  // namespace lumel
