// Radiosity of one moment after another: what was solved before spans most of what comes next. The first
// bounce takes one pass over F; the rest, smooth by then, is projected on to the answers so far (as in
// Galerkin recycling: Parks et al., Recycling Krylov subspaces for sequences of linear systems, 2006), whose
// images under F are kept, so that the residual costs no further pass. Only what exceeds the tolerance is
// solved, and its answer joins the basis: a sky alone, or the sun a few degrees on, soon takes one pass in
// place of ten.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "compute/radiosity.h"

namespace heliodon::compute {

class RelightBasis {
public:
    static constexpr size_t kMostVectors = 160; // per channel: 16 bytes each per patch and vector

    // Both must outlive this, about the same F. `areas`: of the patches; sum_i A_i F_ij = A_j times row sum
    // j.
    RelightBasis(FormFactorOperator& factors, RadiositySolver& solver, std::vector<double> areas)
        : factors_(&factors), solver_(&solver), areas_(std::move(areas)) {}

    // Forgets everything: to be called first, and after the solver got new matter.
    void restart();

    // As RadiositySolver::solve, until the residual is within the same tolerance. It is kept, not measured
    // anew: `bound` counts the rounding of what it was kept by, too, and may exceed the tolerance by that
    // where `converged` is true. Results depend on what was solved before, within the tolerance; the same
    // sequence gives the same bits. As far as the tolerance allows, what the residual gives and takes in all
    // is spread over the reflected light or, by a pass more, over what the residual lights.
    RadiosityReport solve(std::span<const float> emitted, std::span<const uint32_t> channel,
                          std::vector<float>& radiosity, std::vector<float>& gathered,
                          const RadiosityOptions& options = {});

private:
    struct Vector {
        std::vector<float> image;    // (I - K F) u, of unit length and at right angles to the others
        std::vector<float> gathered; // F u
        double rounding = 0;         // by how much the image may miss what `gathered` stands for
    };
    struct Columns;
    void answerFromBasis(Columns& at) const;
    // Columns whose residual is above the tolerance; their answers join the basis.
    void solveRest(Columns& at);
    // What residuals give and take in all.
    void sendRound(Columns& at);
    bool spread(Columns& at, size_t c, const Vector& answer) const; // as `balance`, within the tolerance
    double allowed(const Columns& at, size_t c) const;              // of the residual
    double reflect(Columns& at, size_t c) const; // radiosity of what is gathered; its largest
    // Takes from the residual what the basis answers, and adds the answers' illuminance. Returns the rounding
    // that the residual does not show.
    double project(uint32_t channel, std::span<float> residual, std::span<float> gathered) const;
    // What the residual gives to the patches in all, lumens.
    double given(std::span<const float> residual) const;
    // Takes from the residual as many images of an answer as leave it giving nothing; false, and nothing
    // done, where it would then be larger than `most` anywhere.
    bool balance(const Vector& answer, double most, std::span<float> residual,
                 std::span<float> gathered) const;
    // Joins the basis, freed of what it has; false where nothing is left of it.
    bool learn(uint32_t channel, std::vector<float> image, std::vector<float> gathered);
    // Makes both halves of the newest vectors, one for each entry of `channel`, one to another's by a pass
    // over F: what is left of answers that resemble one another is as much rounding as answer.
    void measure(std::span<const uint32_t> channel);

    FormFactorOperator* factors_;
    RadiositySolver* solver_;
    std::vector<double> areas_;
    std::vector<std::vector<Vector>> basis_; // per channel
};

} // namespace heliodon::compute
