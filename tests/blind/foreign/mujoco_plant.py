def logs(*a): raise NotImplementedError
