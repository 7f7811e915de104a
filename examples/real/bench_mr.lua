-- SPDX-License-Identifier: MIT-0
-- Parking lots and a warehouse of bench-mr, drawn as SVG. The drawings have no queries; these were chosen by hand.
--
--   trellis run examples/real/bench_mr.lua --jobs 2
--   trellis scene bench_mr/polygon/parking1.svg --robot bench_mr/shared/car.svg --png parking1.png

local car = scenes.robot "bench_mr/shared/car.svg"
local mover = scenes.robot "bench_mr/shared/warehouse_robot.svg"

-- The origin is the drawing's upper left corner; y is negative below it.
local problems = {
  -- Out of the lower row, into the gap of the upper one, which is 0.6 m wider than the car.
  scenes.load("bench_mr/polygon/parking1.svg", {
    robot = car, start = {10.5, -12, math.pi / 2}, goal = {4.1, -2.45, math.pi / 2},
  }),
  -- From one side of the street to the other.
  scenes.load("bench_mr/polygon/parking3.svg", {
    robot = car, start = {28, -16, 0}, goal = {13.5, -8.8, math.pi},
  }),
  -- Along the shelves.
  scenes.load("bench_mr/polygon/warehouse.svg", {
    robot = mover, start = {8.5, -8, 0}, goal = {77.5, -66, 0},
  }),
}

return experiment {
  problems   = problems,
  strategies = {
    rrt_connect = rrt_connect { step = 2 },
    nested      = skeleton() >> shrink(0.5) >> lazy() >> rrt_connect { step = 2 },
  },
  seeds    = 3,
  shortcut = 100,
  measure  = tube { delta = 1 },
}
