#include "lumel/estimators/estimator.h"

#include <array>

#include "lumel/estimators/classical.h"
#include "lumel/estimators/weighted.h"

namespace lumel {

namespace {

constexpr std::array kEstimators{
    Estimator{"classical", "mean of f/p; unbiased", classical},
    Estimator{"weighted", "ratio of the means of f/p and g/p; consistent, far less noise on gloss", weighted},
};

}  // namespace

std::span<const Estimator> estimators() { return kEstimators; }

const Estimator* find_estimator(std::string_view name) {
    for (const Estimator& estimator : kEstimators)
        if (estimator.name == name) return &estimator;
    return nullptr;
}

}  // namespace lumel
