-- Nothing, often, is nothing.
return ("").rep("", math.maxinteger)
