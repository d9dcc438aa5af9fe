"""A small deck with every card that is read, in free field."""

CONTROL = """SOL 101
CEND
SPC = 50
MPC = 30
SUBCASE 1
 LOAD = 10
 BCSET = 8
 BOLTLD = 9
SUBCASE 2
 BCONTACT = 9
SUBCASE 3
 BCONTACT = 10
BEGIN BULK
"""


def grid(number: int, x: float, y: float, z: float) -> str:
    return f"GRID,{number},0,{x:.3f},{y:.3f},{z:.3f},0\n"


def cube(first: int, level: float) -> str:
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    places = [(x, y, z + level) for z in (0, 1) for x, y in square]
    return "".join(grid(first + i, *place) for i, place in enumerate(places))


SOLIDS = (
    cube(1, 0.0)
    + cube(11, 1.0)
    + grid(21, 2, 0, 0)
    + grid(22, 2, 1, 0)
    + grid(23, 2, 0, 1)
    + "CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCHEXA,2,2,11,12,13,14,15,16\n,17,18\n"
    + "CPENTA,3,1,2,21,3,6,23,7\nCTETRA,4,1,21,22,3,23\n"
    + "PSOLID,1,9,,TWO,,FULL\nPSOLID,2,9,,TWO,,FULL\nMAT1,9,210000.,80769.23,.3,7.8-9\n"
)
LINES = (
    grid(91, 3, 0, 0)
    + grid(92, 3, 0, 1)
    + grid(93, 3, 0, 2)
    + grid(94, 4, 0, 0)
    + "CBAR,71,50,91,92,1.,0.,0.\nCBEAM,72,51,92,93,1.,0.,0.\nPBAR,50,9,1.,2.,3.,4.\n"
    + "PBEAM,51,9,1.,2.,3.,0.,4.\nCBAR,73,52,91,94,93\nPBARL,52,9,,BOX\n,4.,4.,1.,1.\n"
    + "CBEAM,74,53,92,94,93\nPBEAML,53,9,,TUBE\n,2.,1.\n"
    + "BAROR,,50,,,1.,0.,0.\nCBAR,75,,91,92\n"
    + "CELAS1,61,60,94,1,93,1\nPELAS,60,50.,,,65,60.\nCELAS2,62,7.,94,2\n"
    + "CONM2,63,94,0,5.,0.,0.,0.\n,1.,.1,2.,.2,.3,3.\n"
)
TIES = (
    "CORD2R,4,0,0.,0.,0.,1.,0.,0.\n,0.,1.,0.\nCORD2C,5,0,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    "CORD2S,6,5,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD1R,7,1,2,4,8,11,12,14\n"
    "GRID,95,5,2.,30.,0.,5\nGRID,96,6,2.,30.,10.,6,123\n"
    "RBE2,81,91,123456,1,2,THRU,4\nRBE3,82,,93,123456,1.,123,15,16\n,17,18,.5,123,11\n"
    "MPC,3,95,1,1.,94,1,-1.\n,,94,2,.5\nMPCADD,30,3\nSPC,5,94,3,0.,92,2,0.\n"
    "SPC1,5,12,11,THRU,13\nSPCADD,50,5\n"
)
LOADS = (
    "FORCE,1,94,0,2.,1.,2.,3.\nMOMENT,1,93,4,2.,1.,2.,3.\nLOAD,10,2.,1.5,1,.5,2\n"
    "PLOAD4,2,2,1.,2.,3.,4.,15,17\n,4,1.,0.,0.\nPLOAD4,2,4,1.,,,,21,23\n"
)
CONTACT = (
    "SET1,3,1,THRU,5,EXCEPT,2\nBSURFS,5,,,,1,5,6,7\nBSURFS,6,,,,2,11,13,12\n"
    "BCTSET,4,5,6,0.,-1.,2.\nBCTADD,8,4\nBCTPARM,4,PENN,10.,PENT,1.\nBCRPARA,5,TOP,0.,FLEX\n"
    "BCPROP,31,1\nBSURF,32,2\nBCBODY1,7,,3D,DEFORM,31\nBCBODY,8,3D,DEFORM,32,,0.\n"
    "BCTABL1,9,33\nBCONECT,33,1,2,7,8\nBCONPRG,1,,ICOORD,0,IGLUE,0\nBCONPRP,2,,FRIC,0.\n"
    "BCPARA,0,ERROR,.1\n"
    "BCTABLE,10,,,1\n,SECNDRY,7,,,0.,0.,0\n,,,0\n,PRIMARY,8\n"
    "BOLT,1,1,71\nBOLTFOR,3,5000.,1\nBOLTLD,9,2.,1.,3\nPARAM,WTMASS,2.\n"
)
BULK = SOLIDS + LINES + TIES + LOADS + CONTACT
SUBCASES = (1, 2, 3)
