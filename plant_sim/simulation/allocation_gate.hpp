/// Distinguishes allocations of the tested programs from those of the simulation, so that a test can make only the former fail.
#pragma once

#include <functional>
#include <utility>

namespace plant_sim::simulation {

class AllocationGate {
  public:
    /// Called when the kind changes; `counts`: whether the following allocations are those of the tested programs.
    using Hook = std::function<void(bool counts)>;

    explicit AllocationGate(Hook hook = {}) : hook_(std::move(hook)) {}

    /// Sets the kind for its lifetime.
    class Scope {
      public:
        Scope(AllocationGate& gate, bool counts) : gate_(gate), before_(std::exchange(gate.counts_, counts)) { gate_.notify(); }
        ~Scope() {
            gate_.counts_ = before_;
            gate_.notify();
        }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

      private:
        AllocationGate& gate_;
        bool before_;
    };
    [[nodiscard]] Scope product() { return {*this, true}; }
    [[nodiscard]] Scope simulation() { return {*this, false}; }

  private:
    void notify() const {
        if (hook_) hook_(counts_);
    }
    Hook hook_;
    bool counts_ = false;
};

}  // namespace plant_sim::simulation
