// Weighted least squares of values that are linear in a few terms.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace lumel {

/// A constant, the normal and the position.
inline constexpr int kFitTerms = 7;
using FitTerms = std::array<double, kFitTerms>;

constexpr double product(const FitTerms& a, const FitTerms& b) {
    double sum = 0;
    for (int k = 0; k < kFitTerms; ++k) sum += a[k] * b[k];
    return sum;
}

/// The matrix of the normal equations. A small ridge keeps terms out that hardly vary.
class LinearFit {
public:
    void add(double weight, const FitTerms& t) {
        for (int a = 0; a < kFitTerms; ++a)
            for (int b = 0; b <= a; ++b) matrix_[a][b] += weight * t[a] * t[b];
    }
    /// Terms that the fit has to itself: those that vary.
    double used() const { return used_; }

    /// Replace the matrix by its Cholesky factor, once all is added.
    void factorise() {
        const double weight = matrix_[0][0];
        used_ = 1;
        for (int a = 1; a < kFitTerms; ++a) {
            used_ += matrix_[a][a] / (matrix_[a][a] + kRidge * weight);
            matrix_[a][a] += kRidge * weight;
        }
        for (int i = 0; i < kFitTerms; ++i)
            for (int j = 0; j <= i; ++j) {
                double sum = matrix_[i][j];
                for (int k = 0; k < j; ++k) sum -= matrix_[i][k] * matrix_[j][k];
                matrix_[i][j] = i == j ? std::sqrt(std::max(sum, 1e-30)) : sum / matrix_[j][j];
            }
    }
    /// The coefficients whose weighted sums of products are `b`.
    FitTerms solve(FitTerms b) const {
        for (int i = 0; i < kFitTerms; ++i) {
            for (int k = 0; k < i; ++k) b[i] -= matrix_[i][k] * b[k];
            b[i] /= matrix_[i][i];
        }
        for (int i = kFitTerms - 1; i >= 0; --i) {
            for (int k = i + 1; k < kFitTerms; ++k) b[i] -= matrix_[k][i] * b[k];
            b[i] /= matrix_[i][i];
        }
        return b;
    }

private:
    static constexpr double kRidge = 1e-3;

    std::array<FitTerms, kFitTerms> matrix_{};
    double used_ = 0;
};

}  // namespace lumel
