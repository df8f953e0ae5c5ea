"""The scenes that are studied, in the order of the page, and why their curves are what they are. Who is ahead, and by how much,
is not said here: it follows from the figures."""
from collections import namedtuple

Scene = namedtuple("Scene", "label title text")

SCENES = {
    "free_rotation": Scene("S1", "Free box near the separatrix", """
A box spins freely about its intermediate axis, so near the motion that separates turning over from not (4e-6) that a small
error of its energy changes when it turns over. Nothing touches it and nothing pulls, so Cradle takes the closed form in
Jacobi’s elliptic functions: its points lie on top of each other at rounding, whatever accuracy is asked. Engines step:
those of order one go down with slope one; ODE’s implicit gyroscopic term damps the motion across the separatrix, so that
its curve stays at the top. MuJoCo’s Runge-Kutta has only order two where axes of rotation turn."""),
    "tennis_racket": Scene("R1", "Tennis racket", """
Moments of inertia 1, 2 and 3, spun about the middle one: it turns over again and again. Each integrator shows its order as
the slope of its curve. Cradle has the closed form again; the reference is an integration, and knows the end less well than
it."""),
    "oscillator": Scene("S2", "Ball on a stiff spring", """
A ball of 1 kg on a spring of 1000 N/m for 50 periods. An error of the frequency adds up to an error of the phase. Forces
that are sampled once a step make Bullet and ODE of order two at best; MuJoCo has the spring within its Runge-Kutta steps,
and order four. Of the textbook methods explicit Euler blows up at every large step: it has no stable step on an undamped
spring at all. Cradle’s DOP853 is of order eight: it halves its error for a tenth more of cost."""),
    "hung_box": Scene("R3a", "Box hung by a corner", """
A box hangs by one corner from a spring and tumbles while it bounces: the force depends on the orientation, and the torque
is what engines that freeze it for a step get wrong."""),
    "chain_on_joints": Scene("S3", "Chain on joints", """
Three arms in a row, let go from the horizontal. MuJoCo and Simbody write the chain in its joints’ angles: they have no
constraints to drift, and Runge-Kutta. Bullet and ODE have six coordinates a body, and pull joints together again after they
have parted: by how much stands in the panel below. Cradle has six coordinates a body too, but exact constraint forces
within each stage of DOP853 and a projection after each step: joints hold to rounding. (The drift of the coarsest runs is
that of frames inside long steps, which are interpolated.)"""),
    "chain_on_rods": Scene("S3", "Chain on rods", """
The same with rods between the balls’ centres. MuJoCo’s rods are soft, Bullet has none (the row is ours)."""),
    "double_rod_pendulum": Scene("R4a", "Double rod pendulum", """
Two balls on rods: a motion that is about to be chaotic, but is not in five seconds."""),
    "cradle_on_joints": Scene("S4", "Newton’s cradle, balls touching", """
The first ball is lifted by 45 degrees and falls onto four that touch. What happens is decided in one instant: a solver that
treats all contacts symmetrically lets several balls go, and no step, however small, mends that; that is why the engines’
curves lie flat at the top. Cradle finds the instant of the impact, and lets the touching balls pass the momentum on by
generalized reflections: the last ball goes, as it does in a cradle."""),
    "cradle_with_gaps": Scene("S4", "Newton’s cradle, gaps of 0.1 mm", """
With a tenth of a millimetre between the balls, each contact is an impact of two, and a solver can get the order right once
its steps resolve the time between them. After ten seconds of impacts that errors of the first ones have moved, few do."""),
    "cradle_thirty_degrees": Scene("R7", "Newton’s cradle at 30 degrees", """
Touching balls on rods, lifted by 30 degrees, five seconds."""),
    "bounce_elastic": Scene("S5", "Ball that bounces for ever", """
A ball on a hard floor, restitution 1. Between bounces a parabola, which all have exactly up to their order; what differs is
when the bounce happens: engines bounce at the next step, so that the error goes down with the step at best, and in jumps.
Bullet’s default creates the contact 2 cm ahead and loses the bounce. Cradle has the closed form between bounces, and finds
their instants to rounding."""),
    "bounce_fading_early": Scene("S5", "Ball that bounces ever lower, in flight", """
The same with restitution 0.8, looked at after three seconds, between two bounces."""),
    "bounce_fading": Scene("S5", "Ball that has bounced", """
The same after ten seconds. The ball comes to rest after infinitely many bounces in finite time, and the error at the end is
that of where it rests: whoever lets it rest at all is right in the end, with however coarse a step."""),
    "ball_on_platform": Scene("R12", "Ball onto a hanging platform", """
A ball falls onto a platform that hangs from a spring; both swing, and bounce on each other, restitution 0.5. Impacts and a
smooth force in one scene."""),
    "stack": Scene("S6", "Ten boxes", """
Ten touching cubes. Nothing should happen, and the error is what does: boxes that creep, or a stack that falls. Cradle asks
first whether forces within the friction cones can hold what is at rest; if so, it computes nothing more."""),
    "stack_heavy_top": Scene("S6", "Ten boxes, the highest a thousand times as heavy", """
Iterative solvers carry a load through the stack by one contact an iteration, and at a ratio of 1:1000 they need thousands
of them; with ten or a hundred the stack collapses. Whether forces can hold it is one problem, solved once."""),
    "slope_slide": Scene("S8", "Block that slides", """
A block on a slope of 30 degrees, friction 0.5. The force is constant, and a step that adds the velocity first is off by
half a step: order one for all engines. To Cradle the sliding contact is part of the equations of motion, and DOP853 has a
constant force exactly."""),
    "slope_stick": Scene("S8", "Block that sticks", """
The same slope with friction 0.6: it must not move. Regularised friction creeps."""),
    "crank": Scene("D1", "Crank and piston", """
A driven crank moves a piston by a rod. Where the crank goes the rest is geometry: an error is what the joints have parted by.
Cradle’s joints hold to rounding at any accuracy asked, so that all its points lie at the bottom. Bullet and ODE pull joints
together once a step; MuJoCo closes the loop by a soft constraint, which gives way to the piston’s inertia by millimetres,
unless its time constant goes down with the step; Simbody projects the loop as Cradle does, to the accuracy asked."""),
    "car": Scene("D2", "Car on a slope", """
Four balls on hinges, with a torque of 1 N m each, roll a car up a slope without slip: its acceleration is constant, and a
closed form. Friction holds the balls by what the motors give at that instant; engines find it once a step, and are of order
one by half a step of acceleration. MuJoCo’s friction is soft: its balls creep. To Cradle rolling contacts are part of the
equations of motion. The error is that of the balls’ orientation, after 46 radians."""),
    "shaken_table": Scene("D3", "Block on a shaken table", """
A table swings to and fro; the block on it sticks while friction can give it the table’s acceleration, slips, and sticks
again: nine times in three seconds. As engines know one coefficient of friction, both are equal here: sliding begins at no
speed. Cradle locates each slip and each stick, at any accuracy: its coarsest run has an error below 1e-6 already. Engines are
off by some of a step at each change. No run knows the end better than the dashed line: Cradle counts as sliding what takes 1e-6 g more than
friction gives, which begins 3e-7 s late."""),
}
