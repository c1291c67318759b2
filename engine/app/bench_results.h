// What a bench found, as a table (CSV) and as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace heliodon::app {

struct BenchResult {
    std::string scene;
    size_t patches = 0;
    std::string kernel, setting;
    bool peer = false; // another program
    int runs = 1;      // counted
    struct Seconds {
        double median = 0, least = 0, most = 0; // of the runs
    };
    Seconds wall;               // submit to wait
    Seconds cpu;                // all threads
    Seconds compared;           // either of them: by which plot and front go
    double deviceSeconds = 0;   // median by the device's own clock; 0 for peers
    double rowError = 0;        // RMS over the reference rows of ||F_i - reference||_2
    double rowErrorMax = 0;     // worst of them
    double entryMax = 0;        // worst entry there
    double referenceError = 0;  // RMS of what the reference rows say of their own error
    double claimedRowError = 0; // what the kernel says itself; 0 when it says nothing
    double closureMax = 0, closureRms = 0, reciprocityRms = 0; // before any normalisation
    double pairsPerSecond = 0, raysPerSecond = 0, bytesPerSecond = 0;
    // Shares of the pairs in the reference rows: not facing, hidden, seen whole, seen in part.
    double pairsApart = 0, pairsHidden = 0, pairsVisible = 0, pairsPartial = 0;
    double peakBytes = 0;        // of the process while it ran
    double rooflineFraction = 0; // least time for the work that no method can leave out, over wall.median
    bool onFront = false;        // no other of the scene is nowhere worse and somewhere better
};

struct GatherResult {
    std::string scene;
    size_t patches = 0;
    unsigned columns = 1;
    double wallSeconds = 0, nativeSeconds = 0; // ours; vector instructions on all cores of the processor
    double bytesPerSecond = 0, rooflineFraction = 0;
    double error = 0; // worst relative deviation from sums in double precision
};

// 3e-4, as settings and axes have it.
std::string errorText(double error);

// Marks, scene by scene, what is on the Pareto front of error against median time. Errors below what the
// reference says of its own are equal: their order means nothing.
void markFront(std::vector<BenchResult>& results);

std::string csvOf(const std::vector<BenchResult>& results);
std::string csvOf(const std::vector<GatherResult>& results);
nlohmann::ordered_json jsonOf(const BenchResult& result);
nlohmann::ordered_json jsonOf(const GatherResult& result);

} // namespace heliodon::app
