"""Small decks for tests of the reader: one of almost everything, parts, a solid bolt."""

# Two bricks on top of each other, a bolt of one beam beside them, a load at a coupled node.
DECK = """\
*HEADING
Two bricks, a bolt and a load
** a comment
*NODE, NSET=NALL
1, 0., 0., 0.
2, 2., 0., 0.
3, 2., 3., 0.
4, 0., 3., 0.
5, 0., 0., 1.
6, 2., 0., 1.
7, 2., 3., 1.
8, 0., 3., 1.
11, 0., 0., 1.
12, 2., 0., 1.
13, 2., 3., 1.
14, 0., 3., 1.
15, 0., 0., 2.
16, 2., 0., 2.
17, 2., 3., 2.
18, 0., 3., 2.
100, 1., 1.5, 3.
101, 1., 1.5, 3.
102, 1., 1.5, 0.
103, 1., 1.5, 2.
104, 9., 9., 9.
*ELEMENT, TYPE=C3D8, ELSET=LOWER
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=UPPER
2, 11, 12, 13, 14, 15, 16, 17, 18
*ELEMENT, TYPE=B31, ELSET=BOLT
3, 102, 103
*ELEMENT, TYPE=SPRING2, ELSET=STICK
4, 6, 12
*ELEMENT, TYPE=MASS, ELSET=TIP
5, 100
*NSET, NSET=Bottom
1, 2, 3, 4
*NSET, NSET=TOP, GENERATE
15, 18, 1
*NSET, NSET=BOTH
BOTTOM, TOP
*ELSET, ELSET=BRICKS
LOWER, UPPER
*MATERIAL, NAME=Steel
*ELASTIC
210000., 0.3
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=BRICKS, MATERIAL=STEEL
*BEAM SECTION, ELSET=BOLT, MATERIAL=STEEL, SECTION=CIRC
0.5
1., 0., 0.
*SPRING, ELSET=STICK
1, 1
1.D3
*MASS, ELSET=TIP
2.5E-6
*SURFACE, NAME=SLAVE, TYPE=ELEMENT
LOWER, S2
*SURFACE, NAME=MASTER
2, S1
*SURFACE, NAME=HEAD
UPPER, S2
*SURFACE INTERACTION, NAME=Joint
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1.E6
*CONTACT PAIR, INTERACTION=JOINT, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
*RIGID BODY, NSET=BOTTOM, REF NODE=102
*COUPLING, CONSTRAINT NAME=C1, REF NODE=103, SURFACE=HEAD
*DISTRIBUTING
1, 6
*MPC
BEAM, 100, 103
*EQUATION
2
16, 1, 1., 15, 1, -1.
*PRE-TENSION SECTION, ELEMENT=3, NODE=104
*BOUNDARY
102, 1, 6
*STEP
*STATIC
1., 1.
*CLOAD
104, 1, 400.
100, 3, -7.
*NODE FILE
U
*END STEP
"""

# The same brick twice, moved and turned.
PARTS = """\
*HEADING
*PART, NAME=Brick
*NODE
1, 0., 0., 0.
2, 2., 0., 0.
3, 2., 3., 0.
4, 0., 3., 0.
5, 0., 0., 1.
6, 2., 0., 1.
7, 2., 3., 1.
8, 0., 3., 1.
*ELEMENT, TYPE=C3D8, ELSET=All
1, 1, 2, 3, 4, 5, 6, 7, 8
*SURFACE, NAME=Over
All, S2
*SURFACE, NAME=Under
All, S1
*SOLID SECTION, ELSET=All, MATERIAL=Steel
*END PART
*ASSEMBLY, NAME=Both
*INSTANCE, NAME=Low, PART=Brick
*END INSTANCE
*INSTANCE, NAME=High, PART=Brick
-3., 0., 1.
0., 0., 0., 0., 0., 1., -90.
*END INSTANCE
*NODE
1, 0., 0., 5.
*NSET, NSET=Held, INSTANCE=Low
1, 2, 3, 4
*NSET, NSET=Mixed
Low.1, High.5, Held
*NSET, NSET=Point
1,
*END ASSEMBLY
*MATERIAL, NAME=Steel
*ELASTIC
210000., 0.3
*SURFACE INTERACTION, NAME=Joint
*CONTACT PAIR, INTERACTION=Joint
Low.Over, High.Under
*BOUNDARY
Held, ENCASTRE
High.8, 1
*STEP
*STATIC
*CLOAD
High.5, 3, 2.
*END STEP
"""

# A brick shank in two halves beside a wall.
SHANK = """\
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 2.
6, 1., 0., 2.
7, 1., 1., 2.
8, 0., 1., 2.
9, 0., 0., 3.
10, 1., 0., 3.
11, 1., 1., 3.
12, 0., 1., 3.
21, 1., 0., 0.
22, 2., 0., 0.
23, 2., 1., 0.
24, 1., 1., 0.
25, 1., 0., 2.
26, 2., 0., 2.
27, 2., 1., 2.
28, 1., 1., 2.
99, 0., 0., 0.
*ELEMENT, TYPE=C3D8, ELSET=BOLT
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 5, 6, 7, 8, 9, 10, 11, 12
*ELEMENT, TYPE=C3D8, ELSET=WALL
3, 21, 22, 23, 24, 25, 26, 27, 28
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=BOLT, MATERIAL=M
*SOLID SECTION, ELSET=WALL, MATERIAL=M
*SURFACE, NAME=CUT
1, S2
*SURFACE, NAME=SIDE
1, S4
*SURFACE, NAME=OTHER
3, S6
*SURFACE INTERACTION, NAME=J
*CONTACT PAIR, INTERACTION=J
SIDE, OTHER
*PRE-TENSION SECTION, SURFACE=CUT, NODE=99
*BOUNDARY
1, 1, 3
*STEP
*STATIC
*CLOAD
99, 1, 10.
*END STEP
"""

# Two bricks tied, one of reduced integration; heated, spun and moved at its supports.
TIED = """\
*NODE, NSET=NALL
1, 0., 0., 0.
2, 2., 0., 0.
3, 2., 3., 0.
4, 0., 3., 0.
5, 0., 0., 1.
6, 2., 0., 1.
7, 2., 3., 1.
8, 0., 3., 1.
11, 0., 0., 1.
12, 2., 0., 1.
13, 2., 3., 1.
14, 0., 3., 1.
15, 0., 0., 2.
16, 2., 0., 2.
17, 2., 3., 2.
18, 0., 3., 2.
*ELEMENT, TYPE=C3D8R, ELSET=LOWER
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8I, ELSET=UPPER
2, 11, 12, 13, 14, 15, 16, 17, 18
*MATERIAL, NAME=Hot
*ELASTIC
210000., 0.3
*EXPANSION, ZERO=20.
1.2E-5, 0.
1.4E-5, 100.
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=LOWER, MATERIAL=HOT
*SOLID SECTION, ELSET=UPPER, MATERIAL=COLD
*MATERIAL, NAME=Cold
*ELASTIC
70000., 0.3
*EXPANSION
2.3E-5
*DENSITY
2.7E-9
*SURFACE, NAME=SLAVE
LOWER, S2
*SURFACE, NAME=MASTER
UPPER, S1
*TIE, NAME=GLUED, POSITION TOLERANCE=0.1
SLAVE, MASTER
*INITIAL CONDITIONS, TYPE=TEMPERATURE
NALL, 20.
*BOUNDARY
1, 1, 3
2, 2, 3
3, 3
*STEP
*STATIC
*BOUNDARY
15, 3, 3, 0.02
*DLOAD
LOWER, CENTRIF, 1.E6, 0., 0., 0., 0., 0., 1.
*TEMPERATURE
NALL, 60.
*END STEP
"""

# Directions that differ, along axes of their own; a step that changes the structure.
WOOD = (
    TIED.replace("C3D8R", "C3D8")
    .replace(
        "*ELASTIC\n70000., 0.3",
        "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n9., 8., 7., .1, .2, .3, 3., 4.,\n5.",
    )
    .replace("*ELASTIC\n210000., 0.3", "*ELASTIC, TYPE=ORTHO\n9., 1., 8., 1., 1., 7., 3., 4.,\n5.")
    .replace("*TEMPERATURE\nNALL, 60.\n", "")
    .replace("MATERIAL=COLD", "MATERIAL=COLD, ORIENTATION=ALONG")
    .replace(
        "*MATERIAL, NAME=Hot",
        "*ORIENTATION, NAME=ALONG\n1., 2., 3., 3., -2., 1., .1, .2, .3\n2, 30.\n"
        "*MATERIAL, NAME=Hot",
    )
    + "*STEP\n*STATIC\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\nSLAVE, MASTER\n*END STEP\n"
)

# Nodes on a plane, a line and in a mean rotation, a turned coupling, and what a step removes.
TURNED = DECK.replace(
    "*STEP\n",
    "*MPC\nPLANE, 15, 16, 17, 18\nMEANROT, 5, 5, 5, 6, 6, 6, 7, 7, 7\n0, 8, 8, 8, 101\n"
    "*ORIENTATION, NAME=ROUND, SYSTEM=CYLINDRICAL\n1., 1.5, 0., 1., 1.5, 1.\n"
    "*COUPLING, CONSTRAINT NAME=C2, REF NODE=102, SURFACE=SLAVE, ORIENTATION=ROUND\n"
    "*KINEMATIC\n2, 3\n*AMPLITUDE, NAME=RAMP\n0., 0., 1., 1.\n*STEP\n",
    1,
).replace(
    "*END STEP\n",
    "*CLOAD, AMPLITUDE=RAMP, TIME DELAY=0.25\n100, 2, 3.\n"
    "*MODEL CHANGE, TYPE=ELEMENT, REMOVE\n4\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\n"
    "SLAVE, MASTER\n*END STEP\n",
    1,
)
