#!/usr/bin/env python3
"""The page of charts: factors between engines whose curves are power laws come out as the closed forms have them, and what is
lost is said.

    charts_test.py SOURCE_FOLDER
"""
import json, math, os, re, sys, tempfile, unittest

SOURCE = os.path.abspath(sys.argv[1])
sys.path.insert(0, os.path.join(SOURCE, "charts"))

import engine_table, maps, piles
from frontier import cost_at, cost_factors, error_at, error_factors, frontier, lost_levels
from page import page
from study_file import Reference, floor_of, order_of, points_of, read_rows
from verdict import figures, our_edge, rivals_of, verdict

COLUMNS = ("scene,engine,method,setting,error,cpu_seconds_per_simulated_second,evaluations,energy_drift,constraint_drift,"
           "penetration,status\n")
FLOOR = 1e-14


def law(first_error, order, costs):
    """Points of error = first_error (cost / 1e-4)^-order."""
    return [(cost, first_error * (cost / 1e-4) ** -order) for cost in costs]


def line(engine, method, setting, cost, error, status="ok"):
    return f"oscillator,{engine},{method},{setting},{error},{cost},{4 / setting},1e-9,0,0,{status}\n"


def table(ours, theirs, method="ode"):
    """study.csv of two power laws, and of RK4 with a run that blew up; steps are halved, accuracies a tenth."""
    text = COLUMNS + "".join(line("cradle", "plan", 10.0 ** -(i + 2), *point) for i, point in enumerate(ours))
    text += "".join(line("ode", method, 0.01 / 2 ** i, *point) for i, point in enumerate(theirs))
    text += line("cradle", "rk4", 0.2, "nan", "nan", "unstable")
    return text + "".join(line("cradle", "rk4", 0.1 / 2 ** i, 1e-3 * 2 ** i, 1e-2 / 16 ** i) for i in range(5))


def rows_of(text):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "study.csv")
        with open(path, "w") as file:
            file.write(text)
        return read_rows(path)


OURS = law(1e-3, 4, [1e-4, 2e-4, 4e-4, 8e-4])
THEIRS = law(1e-1, 1, [1e-4 * 2 ** i for i in range(11)])  # down to 1e-4


class Factors(unittest.TestCase):
    def test_of_cost_are_those_of_the_laws(self):
        # Equal error e: theirs costs 1e-4 (0.1/e), ours 1e-4 (1e-3/e)^(1/4), and never less than its first run.
        factors = cost_factors(OURS, THEIRS)
        self.assertAlmostEqual(factors[0].at, 0.1)
        self.assertLess(factors[-1].at, 1.01e-4)
        for factor in factors:
            expected = 0.1 / factor.at / max(1, 1e-3 / factor.at) ** 0.25
            self.assertAlmostEqual(factor.value / expected, 1, delta=1e-12)

    def test_of_error_are_those_of_the_laws(self):
        factors = error_factors(OURS, THEIRS)
        for factor in factors:
            expected = 0.1 / (factor.at / 1e-4) / (1e-3 * (min(factor.at, 8e-4) / 1e-4) ** -4)
            self.assertAlmostEqual(factor.value / expected, 1, delta=1e-12)
        self.assertAlmostEqual(factors[0].value, 100)

    def test_where_curves_cross_the_loss_begins(self):
        # Theirs 1e-2 (c/1e-4)^-1 and ours 1 (c/1e-4)^-4 meet at c = 1e-4 100^(1/3), e = 1e-2 / 100^(1/3): above they are cheaper.
        ours = frontier(law(1, 4, [1e-4 * 1.5 ** i for i in range(15)]))
        theirs = frontier(law(1e-2, 1, [1e-4 * 1.5 ** i for i in range(15)]))
        (worst, least, factor), = lost_levels(cost_factors(ours, theirs))
        self.assertAlmostEqual(worst, 0.1)
        self.assertAlmostEqual(least / (1e-2 / 100 ** (1 / 3)), 1, delta=1e-9)
        self.assertLess(factor, 1)

    def test_dominated_points_change_nothing(self):
        worse = [(2 * cost, 2 * error) for cost, error in THEIRS]
        self.assertEqual(frontier(THEIRS + worse), frontier(THEIRS))

    def test_beyond_a_frontier_there_is_nothing_to_compare(self):
        edge = frontier(THEIRS)
        self.assertIsNone(cost_at(edge, 1e-6))
        self.assertIsNone(error_at(edge, 1e-5))
        self.assertEqual(cost_at(edge, 0.5), edge[0][0])
        self.assertEqual(error_at(edge, 1.0), edge[-1][1])


class Words(unittest.TestCase):
    def test_a_gain_is_said_with_its_factors(self):
        won, lost, _ = verdict(rows_of(table(OURS, THEIRS)), FLOOR)
        # At the last of theirs, 0.1 / 1024, the factor is 1024 / 10.24^(1/4) = 572.
        self.assertIn("it costs 1 times as much (ODE, at an error of 0.1) up to 570 times (ODE, at 9.8e-5)", won[0])
        self.assertEqual(lost, [])

    def test_a_broken_method_moves_its_curve_and_the_verdict(self):
        broken = [(cost, 1e4 * error) for cost, error in OURS]
        rows = rows_of(table(broken, THEIRS))
        self.assertEqual([error / whole[1] for (_, error), whole in zip(our_edge(rows, FLOOR), OURS)], [1e4] * 4)
        won, lost, _ = verdict(rows, FLOOR)
        self.assertEqual(won, [])
        self.assertIn("ODE is cheaper than Cradle at errors from 0.1 to", lost[0])
        self.assertTrue(any("ODE reaches an error of 9.8e-5, Cradle only 2.4e-3." in text for text in lost), lost)

    def test_errors_below_the_reference_are_the_floor(self):
        rows = rows_of(table(OURS, THEIRS))
        floor = floor_of(Reference(5e-4, "RK4", ""))
        self.assertEqual(our_edge(rows, floor), [(1e-4, 1e-3)])
        self.assertEqual(floor_of(Reference(math.inf, "RK4", "")), 1e-16)

    def test_orders_are_recovered_as_slopes(self):
        rows = rows_of(table(OURS, THEIRS))
        self.assertAlmostEqual(order_of([row for row in rows if row.method == "rk4"], FLOOR), 4)
        self.assertAlmostEqual(order_of([row for row in rows if row.method == "ode"], FLOOR), 1)

    def test_an_engine_without_a_good_run_is_told(self):
        text = COLUMNS + "".join(line("cradle", "plan", 0.01, *point) for point in OURS) + line("ode", "ode", 0.1, "nan", "nan", "unstable")
        self.assertIn("ODE fails at every setting.", verdict(rows_of(text), FLOOR)[2])
        self.assertEqual(figures(rows_of(text), FLOOR)[1][1:4], ["-", "-", "-"])

    def test_piles_are_read_and_losses_said(self):
        text = ("Bullet 324 with double precision\n1000 turned, 600 steps, one thread\n"
                "  cradle  falling  4.000 ms (1.25 of Bullet's), then until rest  1.500 ms, all  0.800 ms (0.16 of Bullet's)\n"
                "          deepest falling   4.0 mm, later   0.5 mm, at the end  0.1 mm; rest at 3.50 s\n"
                "  Bullet  falling  3.200 ms (1.00 of Bullet's), then until rest  4.500 ms, all  5.000 ms (1.00 of Bullet's)\n"
                "          deepest falling  17.0 mm, later  16.0 mm, at the end  2.0 mm; rest at -1.00 s\n")
        found = dict((line[0], [float(number) for number in line[1:]]) for line in piles.FIGURES.findall(text))
        self.assertEqual(found["cradle"], [4.0, 1.5, 0.8, 4.0, 0.5, 0.1, 3.5])
        said = piles.sentence("turned", found["cradle"], "Bullet", found["Bullet"])
        self.assertIn("Cradle loses: while they fall", said)
        self.assertEqual(piles.rest(found["Bullet"][6]), "never")


class Maps(unittest.TestCase):
    def test_are_embedded_with_their_words(self):
        with tempfile.TemporaryDirectory() as folder:
            os.mkdir(os.path.join(folder, "maps"))
            for name, text in (("a.csv", "# Step < stiffness\n# ten periods\n# Why & how\nx,y\n1,2\n"), ("a.svg", "<svg/>")):
                with open(os.path.join(folder, "maps", name), "w") as file:
                    file.write(text)
            section = maps.section(maps.read(folder))
        self.assertIn("<h3>Step &lt; stiffness</h3><p>Why &amp; how</p>", section)
        self.assertIn('src="data:image/svg+xml;base64,PHN2Zy8+"', section)


class Readme(unittest.TestCase):
    REFERENCES = {"oscillator": Reference(1e-13, "DOP853", "RK4 agrees")}

    def test_has_factors_and_least_errors_beside_what_cradle_chooses(self):
        # OURS has accuracies 1e-2 ... 1e-5; with one run more, at 1e-6: order 4, so a sixteenth of the error for twice the cost.
        ours = [*OURS, (1.6e-3, OURS[-1][1] / 16)]
        text = engine_table.table({"oscillator": rows_of(table(ours, THEIRS))}, self.REFERENCES)
        self.assertIn("| Ball on a stiff spring | 1.5e-8; 1.6 | - | 1 to 570; 9.8e-5 | - | - |", text)
        self.assertIn("In none of these scenes", text)

    def test_marks_and_tells_what_is_lost(self):
        text = engine_table.table({"oscillator": rows_of(table([(c, 1e4 * e) for c, e in OURS], THEIRS))}, self.REFERENCES)
        self.assertRegex(text, r"\| fails \| - \| \*\*0\.\d+ to [^|]*\*\*; 9.8e-5 \|")
        self.assertIn("- Ball on a stiff spring: ODE is cheaper than Cradle", text)

    def test_is_changed_only_where_its_table_is(self):
        text = f"before\n{engine_table.BEGIN}old\n{engine_table.END}after\n"
        self.assertEqual(engine_table.with_table(text, "new\n"), f"before\n{engine_table.BEGIN}new\n{engine_table.END}after\n")
        self.assertRaises(engine_table.MarkError, engine_table.with_table, "before\nafter\n", "new\n")

    def test_of_this_project_has_a_place_for_its_table(self):
        with open(os.path.join(SOURCE, "docs", "engines.md")) as file:
            engine_table.with_table(file.read(), "new\n")


class Page(unittest.TestCase):
    def setUp(self):
        self.text = page({"oscillator": rows_of(table([(c, 1e4 * e) for c, e in OURS], THEIRS))},
                         {"oscillator": Reference(1e-13, "DOP853 <fine>", "RK4 agrees")}, "", "", [("Machine", "a & b")])

    def test_has_nothing_outside_of_it(self):
        self.assertEqual(re.findall(r'(?:src|href)="(?!#|data:)[^"]*"|https?://|@import|url\(', self.text), [])

    def test_says_losses_escapes_texts_and_marks_cells(self):
        self.assertIn("Where Cradle loses:", self.text)
        self.assertIn("DOP853 &lt;fine&gt;", self.text)
        self.assertIn("a &amp; b", self.text)
        self.assertRegex(self.text, r'<td class="behind">0\.\d')

    def test_every_mark_has_a_run(self):
        data = json.loads(re.search(r'<script type="application/json">(.*?)</script>', self.text)[1])
        marks = [int(number) for number in re.findall(r'data-r="(\d+)"', self.text)]
        self.assertEqual(set(marks), set(range(len(data["rows"]))))
        self.assertEqual(data["rows"][marks[0]][0] in data["methods"], True)
        self.assertEqual(self.text.count('<svg class="chart"'), 3)  # errors twice, and energy: nothing is tied or touches

    def test_points_stand_where_their_values_are(self):
        # Of two runs of the law with order one, the cost goes up by as many decades as the error goes down.
        curve = re.search(r'<g class="curve" data-m="ode".*?points="([^"]*)"', self.text)[1]
        points = [tuple(map(float, point.split(","))) for point in curve.split()]
        ticks = [[float(place) for place in re.findall(pattern, self.text.split("</svg>")[1])]
                 for pattern in (r'class="grid" d="M([\d.]+),\d+V', r'class="grid" d="M\d+,([\d.]+)H')]
        decades = [abs(values[1] - values[0]) for values in ticks]
        across, down = points[-1][0] - points[0][0], points[-1][1] - points[0][1]
        self.assertAlmostEqual(across / decades[0], 10 * math.log10(2), delta=0.02)
        self.assertAlmostEqual(down / decades[1] * 2, 10 * math.log10(2), delta=0.04)  # every other decade has a line


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
