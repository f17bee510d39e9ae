//! The digital twin: kit, layout, goal and seed to a robot to drive and the truth for the referee (section III-E).
