// The property tree that the firmware's build generates from its interface description: only the part that drivers use.
#pragma once
#include "odrive_main.h"
#include <fibre/../../protocol.hpp>
#include <fibre/introspection.hpp>
#include <deque>
#include <utility>
#include <vector>

using Children = std::vector<std::pair<const char*, Introspectable>>;

class Branch : public TypeInfo {
public:
    Branch(const Children& children, const std::vector<PropertyInfo>& table)
        : TypeInfo(table.data(), table.size()), children_(children) {}

    introspectable_storage_t get_child(introspectable_storage_t, size_t at) const override {
        return children_[at].second.storage_;
    }

    static Introspectable of(const Children& children) {
        // A deque keeps its elements at the same address.
        static std::deque<std::vector<PropertyInfo>> tables;
        static std::deque<Branch> branches;
        tables.emplace_back();
        for (const auto& [name, child] : children)
            tables.back().push_back({name, child.type_info_});
        branches.emplace_back(children, tables.back());
        return make_introspectable<const void*>(nullptr, &branches.back());
    }

private:
    Children children_;
};

template<typename T> Introspectable leaf(T* value) {
    return FibrePropertyTypeInfo<Property<T>>::make_introspectable(Property<T>(value));
}

inline Introspectable tree(Axis& axis) {
    return Branch::of({
        {"error", leaf(&axis.error)},
        {"current_state", leaf(&axis.current_state)},
        {"requested_state", leaf(&axis.requested_state)},
        {"config", Branch::of({
            {"enable_watchdog", leaf(&axis.enable_watchdog)},
            {"watchdog_timeout", leaf(&axis.watchdog_timeout)},
        })},
        {"motor", Branch::of({
            {"error", leaf(&axis.motor_.error)},
            {"current_control", Branch::of({{"Iq_measured", leaf(&axis.motor_.iq_measured)}})},
            {"fet_thermistor", Branch::of({{"temperature", leaf(&axis.motor_.fet_celsius)}})},
            {"motor_thermistor", Branch::of({{"temperature", leaf(&axis.motor_.motor_celsius)}})},
            {"config", Branch::of({
                {"torque_constant", leaf(&axis.motor_.config_.torque_constant)},
                {"current_lim", leaf(&axis.motor_.config_.current_lim)},
            })},
        })},
        {"encoder", Branch::of({{"error", leaf(&axis.encoder_.error)}})},
        {"controller", Branch::of({
            {"error", leaf(&axis.controller_.error)},
            {"input_vel", leaf(&axis.controller_.input_vel_)},
            {"input_torque", leaf(&axis.controller_.input_torque_)},
            {"config", Branch::of({
                {"control_mode", leaf(&axis.controller_.config_.control_mode)},
                {"input_mode", leaf(&axis.controller_.config_.input_mode)},
                {"vel_limit", leaf(&axis.controller_.config_.vel_limit)},
            })},
        })},
    });
}

template<typename T> struct ODrive3TypeInfo {
    static Introspectable make_introspectable(ODrive& drive) {
        return Branch::of({
            {"vbus_voltage", leaf(&drive.vbus_voltage)},
            {"error", leaf(&drive.error)},
            {"axis0", tree(axes[0])},
            {"axis1", tree(axes[1])},
        });
    }
};
